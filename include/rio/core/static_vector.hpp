// SPDX-License-Identifier: BSD-3-Clause
// A vector of fixed capacity that never allocates. C++17.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "rio/core/assert.hpp"

namespace rio {

/// Up to `Capacity` elements stored in place. T must be default constructible.
template <class T, std::size_t Capacity>
class StaticVector {
 public:
  using value_type = T;

  StaticVector() = default;
  StaticVector(const StaticVector&) = default;
  /// Copies the elements in use only, not the spare capacity.
  StaticVector& operator=(const StaticVector& other) {
    std::copy(other.begin(), other.end(), begin());
    size_ = other.size_;
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == Capacity; }
  void clear() { size_ = 0; }

  /// Appends; false (and unchanged) when full.
  bool push_back(const T& value) {
    if (full()) return false;
    items_[size_++] = value;
    return true;
  }
  void pop_back() {
    RIO_ASSERT(!empty());
    --size_;
  }
  /// Shrinks or grows to n elements; elements gained keep whatever value their slot last had.
  void resize(std::size_t n) {
    RIO_ASSERT(n <= Capacity);
    size_ = n;
  }
  /// Removes element i, keeping the order of the rest: O(n).
  void erase(std::size_t i) {
    RIO_ASSERT(i < size_);
    for (std::size_t k = i + 1; k < size_; ++k) items_[k - 1] = items_[k];
    --size_;
  }

  T& operator[](std::size_t i) {
    RIO_ASSERT(i < size_);
    return items_[i];
  }
  const T& operator[](std::size_t i) const {
    RIO_ASSERT(i < size_);
    return items_[i];
  }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }
  const T& front() const { return (*this)[0]; }

  T* begin() { return items_.data(); }
  T* end() { return items_.data() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, Capacity> items_;  // no braces: compilers would initialise every element
  std::size_t size_ = 0;
};

}  // namespace rio
