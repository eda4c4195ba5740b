// The processes that mpirun started to solve one case together. The first one runs the program. The others have
// a part of each problem that it solves, and execute its orders on that part. So every decision is made once, by the
// first rank, and only this rank uses the scene, the store and the terminal. Only ranks.cc calls MPI.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <type_traits>

namespace touchstone::reference {

/// Orders of the first rank to a part. The cells of each rank are fixed when the part is made.
enum class Order {
  forces,     ///< internal forces of the part's cells
  pattern,    ///< the sparsity pattern of the part's matrix
  assemble,   ///< its values
  pressures,  ///< the pressures of the part's cells after a displacement
  analyse,    ///< of the linear solver, as the following
  factorise,
  solve,
};

namespace ranks {

/// Joins the other processes where mpirun, or a batch system with MPI, started this one; otherwise does nothing, and
/// the process is the only rank. Created once, by main(). When the first rank's session ends, the others end too.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

/// 1 without a session or without mpirun.
[[nodiscard]] int count() noexcept;
[[nodiscard]] int own() noexcept;
[[nodiscard]] inline bool first() noexcept { return own() == 0; }
/// Ranks on this machine, this one included.
[[nodiscard]] int on_this_machine() noexcept;
/// Threads a rank may use: threads_to_use(), divided among the ranks that run on the same processors, unless
/// OMP_NUM_THREADS gives the number for each.
[[nodiscard]] int threads() noexcept;

/// From the first rank to all others; without others does nothing. Every rank must pass the same size.
void send(const void* data, std::size_t bytes);
void receive(void* data, std::size_t bytes);
template <class Range>
void send(const Range& range) {
  static_assert(std::is_trivially_copyable_v<std::remove_reference_t<decltype(*range.data())>>);
  send(range.data(), static_cast<std::size_t>(range.size()) * sizeof(*range.data()));
}
template <class Range>
void receive(Range& range) {
  static_assert(std::is_trivially_copyable_v<std::remove_reference_t<decltype(*range.data())>>);
  receive(range.data(), static_cast<std::size_t>(range.size()) * sizeof(*range.data()));
}

/// Sums over all ranks, on the first one; the values of the others are undefined afterwards.
void sum_on_first(double* values, std::size_t size);
/// The largest of all ranks, on the first one.
[[nodiscard]] double largest_on_first(double value);

/// Ends every rank with a message and exit code 1. For a failure on one rank, for which the others would wait for ever.
[[noreturn]] void end_all(const char* message);

/// A problem's part on a rank other than the first.
class Part {
 public:
  virtual ~Part() = default;
  /// Executes an order of the first rank.
  virtual void follow(Order order) = 0;
};

/// The first rank's handle to the parts of one problem on the other ranks; destroying it destroys them.
class Lead {
 public:
  /// @param kind  of the parts, for follow_orders(); their maker receives what the first rank sends next
  explicit Lead(int kind);
  ~Lead();
  Lead(const Lead&) = delete;
  Lead& operator=(const Lead&) = delete;

  /// Every part executes an order while this rank does its own part of it, `share`. An exception from that ends all
  /// ranks, since the others would wait for the rest of it.
  template <class Share>
  auto jointly(Order order, const Share& share) const {
    give(order);
    try {
      return share();
    } catch (const std::exception& error) {
      end_all(error.what());
    }
  }

 private:
  void give(Order order) const;
  int part_;
};

/// The main loop of every rank but the first: creates parts and executes orders until the first rank's session ends.
using PartMaker = std::function<std::unique_ptr<Part>()>;
void follow_orders(const std::map<int, PartMaker>& makers);

}  // namespace ranks
}  // namespace touchstone::reference
