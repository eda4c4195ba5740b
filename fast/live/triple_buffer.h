// The newest value from one thread to another. Neither ever waits for the other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace touchstone::live {

/// One writer, one reader. Of three slots the writer owns one, the reader one, and the third is exchanged by a
/// single exchange: both sides are wait-free, and values that were not read are overwritten by newer ones.
template <class T>
class TripleBuffer {
 public:
  /// @param initial copied into every slot, so that a slot of it has all the storage it needs
  explicit TripleBuffer(const T& initial) : slots_{Slot{initial}, Slot{initial}, Slot{initial}} {}
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  /// Writer: the slot to fill; holds an old value.
  [[nodiscard]] T& back() noexcept { return slots_[back_].value; }
  /// Writer: makes back() the newest value.
  void publish() noexcept { back_ = shared_.exchange(back_ | unread, std::memory_order_acq_rel) & index; }

  /// Reader: takes the newest value into front().
  /// @returns false where none came since the last call; front() stays
  [[nodiscard]] bool take() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & unread) == 0) return false;
    front_ = shared_.exchange(front_, std::memory_order_acq_rel) & index;
    return true;
  }
  /// Reader: the value last taken.
  [[nodiscard]] const T& front() const noexcept { return slots_[front_].value; }

 private:
  static constexpr std::uint32_t index = 3, unread = 4;
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  struct alignas(64) Slot {
    T value;
  };
  std::array<Slot, 3> slots_;
  alignas(64) std::atomic<std::uint32_t> shared_{2};
  alignas(64) std::uint32_t back_ = 0;   ///< writer's
  alignas(64) std::uint32_t front_ = 1;  ///< reader's
};

}  // namespace touchstone::live
