// SPDX-License-Identifier: BSD-3-Clause
// A first-in first-out ring allocated once. C++17.
#pragma once

#include <cstddef>
#include <vector>

#include "rio/core/assert.hpp"

namespace rio {

/// Queue of at most `capacity` elements; index 0 is the oldest.
template <class T>
class Ring {
 public:
  explicit Ring(std::size_t capacity) : items_(capacity) { RIO_ASSERT(capacity > 0); }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return items_.size(); }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == items_.size(); }
  void clear() { size_ = 0; }

  /// Appends, dropping the oldest element when full.
  void push_back(const T& value) {
    if (full()) pop_front();
    items_[wrap(first_ + size_)] = value;
    ++size_;
  }
  void pop_front() {
    RIO_ASSERT(!empty());
    first_ = wrap(first_ + 1);
    --size_;
  }

  T& operator[](std::size_t i) {
    RIO_ASSERT(i < size_);
    return items_[wrap(first_ + i)];
  }
  const T& operator[](std::size_t i) const {
    RIO_ASSERT(i < size_);
    return items_[wrap(first_ + i)];
  }
  const T& front() const { return (*this)[0]; }
  const T& back() const { return (*this)[size_ - 1]; }

 private:
  std::size_t wrap(std::size_t i) const { return i < items_.size() ? i : i - items_.size(); }

  std::vector<T> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace rio
