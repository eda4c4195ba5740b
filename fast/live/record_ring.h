// Records from the tick to the thread that writes them down.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace touchstone::live {

/// Bounded queue of fixed-size records, one producer, one consumer, both wait-free. A record that finds it full is
/// dropped and counted: the tick does not wait for a disk.
template <class T>
class RecordRing {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  /// @param capacity at least; rounded up to a power of two
  explicit RecordRing(std::size_t capacity)
      : slots_(std::bit_ceil(std::max<std::size_t>(capacity, 1))), mask_(slots_.size() - 1) {}
  RecordRing(const RecordRing&) = delete;
  RecordRing& operator=(const RecordRing&) = delete;

  /// Producer. @returns false where the record was dropped
  bool push(const T& record) noexcept {
    const std::uint64_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[end & mask_] = record;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// Consumer. @returns false where there is none
  [[nodiscard]] bool pop(T& record) noexcept {
    const std::uint64_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    record = slots_[begin & mask_];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  std::vector<T> slots_;
  std::size_t mask_;
  alignas(64) std::atomic<std::uint64_t> begin_{0};
  alignas(64) std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint64_t> dropped_{0};  ///< written by the producer
};

}  // namespace touchstone::live
