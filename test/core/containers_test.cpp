// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include "rio/core/assert.hpp"
#include "rio/core/ring.hpp"
#include "rio/core/static_vector.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

struct AssertFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Turns failed assertions into exceptions while it lives.
class ThrowOnAssert {
 public:
  ThrowOnAssert() : previous_(assert_handler()) {
    assert_handler() = [](const char* condition, const char*, int) {
      throw AssertFailed(condition);
    };
  }
  ~ThrowOnAssert() { assert_handler() = previous_; }
  ThrowOnAssert(const ThrowOnAssert&) = delete;
  ThrowOnAssert& operator=(const ThrowOnAssert&) = delete;

 private:
  AssertHandler previous_;
};

template <class Container, class Reference>
void expect_same(const Container& actual, const Reference& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  EXPECT_EQ(actual.empty(), expected.empty());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(actual[i], expected[i]) << i;
  if (expected.empty()) return;
  EXPECT_EQ(actual.front(), expected.front());
  EXPECT_EQ(actual.back(), expected.back());
}

TEST(Ring, BehavesAsABoundedDeque) {
  for (const std::size_t capacity : {1U, 2U, 3U, 7U}) {
    test::Random random(static_cast<unsigned>(capacity));
    Ring<int> ring(capacity);
    std::deque<int> reference;
    EXPECT_EQ(ring.capacity(), capacity);
    for (int i = 0; i < 2000; ++i) {  // wraps around hundreds of times
      const double action = random.uniform(0.0, 1.0);
      if (action < 0.6) {
        ring.push_back(i);
        if (reference.size() == capacity) reference.pop_front();
        reference.push_back(i);
      } else if (action < 0.99) {
        if (reference.empty()) continue;
        ring.pop_front();
        reference.pop_front();
      } else {
        ring.clear();
        reference.clear();
      }
      EXPECT_EQ(ring.full(), reference.size() == capacity);
      expect_same(ring, reference);
    }
  }
}

TEST(Ring, ElementsCanBeWritten) {
  Ring<int> ring(3);
  for (int i = 0; i < 5; ++i) ring.push_back(i);
  ring[1] = 30;
  expect_same(ring, std::vector<int>{2, 30, 4});
}

TEST(StaticVector, BehavesAsABoundedVector) {
  constexpr std::size_t kCapacity = 5;
  test::Random random(11);
  StaticVector<int, kCapacity> v;
  std::vector<int> reference;
  for (int i = 0; i < 5000; ++i) {
    const double action = random.uniform(0.0, 1.0);
    if (action < 0.5) {
      EXPECT_EQ(v.push_back(i), reference.size() < kCapacity);
      if (reference.size() < kCapacity) reference.push_back(i);
    } else if (action < 0.7) {
      if (reference.empty()) continue;
      v.pop_back();
      reference.pop_back();
    } else if (action < 0.95) {
      if (reference.empty()) continue;
      const std::size_t at = random.index(reference.size());
      v.erase(at);
      reference.erase(reference.begin() + static_cast<std::ptrdiff_t>(at));
    } else if (action < 0.98) {
      const std::size_t n = random.index(reference.size() + 1);
      v.resize(n);
      reference.resize(n);
    } else {
      v.clear();
      reference.clear();
    }
    EXPECT_EQ(v.full(), reference.size() == kCapacity);
    expect_same(v, reference);
    EXPECT_TRUE(std::equal(v.begin(), v.end(), reference.begin(), reference.end()));
  }
}

TEST(StaticVector, GrowsOverOldValuesAndCopiesByValue) {
  StaticVector<int, 4> v;
  for (const int x : {1, 2, 3}) v.push_back(x);
  v.resize(1);
  v.resize(3);
  expect_same(v, std::vector<int>{1, 2, 3});
  StaticVector<int, 4> copy = v;
  copy.back() = 9;
  copy[0] = 7;
  expect_same(v, std::vector<int>{1, 2, 3});
  expect_same(copy, std::vector<int>{7, 2, 9});
}

TEST(Assert, ConditionIsEvaluatedOnceAndSilentWhenTrue) {
  const ThrowOnAssert guard;
  int calls = 0;
  const auto condition = [&calls] { return ++calls > 0; };
  RIO_ASSERT(condition());
#ifdef NDEBUG
  EXPECT_EQ(calls, 0);
  (void)condition;
#else
  EXPECT_EQ(calls, 1);
#endif
}

#ifndef NDEBUG
TEST(Assert, HandlerIsReplaceableAndSeesTheCondition) {
  const ThrowOnAssert guard;
  try {
    RIO_ASSERT(1 + 1 == 3);
    FAIL() << "the handler was not called";
  } catch (const AssertFailed& failure) {
    EXPECT_STREQ(failure.what(), "1 + 1 == 3");
  }
}

TEST(Assert, GuardsTheContainers) {
  const ThrowOnAssert guard;
  EXPECT_THROW(Ring<int>(0), AssertFailed);
  Ring<int> ring(2);
  EXPECT_THROW(ring.pop_front(), AssertFailed);
  EXPECT_THROW(ring.front(), AssertFailed);
  EXPECT_THROW(ring.back(), AssertFailed);
  ring.push_back(1);
  EXPECT_THROW(ring[1], AssertFailed);
  EXPECT_NO_THROW(ring[0]);

  StaticVector<int, 2> v;
  EXPECT_THROW(v.pop_back(), AssertFailed);
  EXPECT_THROW(v.erase(0), AssertFailed);
  EXPECT_THROW(v.back(), AssertFailed);
  EXPECT_THROW(v.front(), AssertFailed);
  EXPECT_THROW(v.resize(3), AssertFailed);
  v.push_back(1);
  EXPECT_THROW(v[1], AssertFailed);
  EXPECT_NO_THROW(v[0]);
}

TEST(AssertDeathTest, DefaultHandlerNamesTheConditionAndAborts) {
  EXPECT_DEATH(RIO_ASSERT(2 < 1), "containers_test.cpp:[0-9]+: RIO_ASSERT\\(2 < 1\\) failed");
}
#endif

}  // namespace
}  // namespace rio
