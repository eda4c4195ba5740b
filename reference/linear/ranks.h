// The processes that mpirun started to solve one case together. The first one runs the program; of each problem it
// solves the others take a part, and do with it what the first one orders. So every decision is made once, by the
// first, and only it sees the scene, the store and the terminal. ranks.cc is the one file that sees MPI.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <type_traits>

namespace touchstone::reference {

/// What the first rank may order of a part. Which rank holds which cells is fixed when the part is made.
enum class Order {
  forces,     ///< internal forces of the part's cells
  pattern,    ///< the places of the part's matrix
  assemble,   ///< its values
  pressures,  ///< the pressures of the part's cells after a displacement
  analyse,    ///< of the linear solver, as the following
  factorise,
  solve,
};

namespace ranks {

/// Joins the other processes where mpirun, or a batch system that knows MPI, started this one; does nothing where not,
/// and the process is alone. Made once, by main(). The first rank's end lets the others go.
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
/// Threads a rank may use: threads_to_use(), shared with the ranks that run on the same processors unless
/// OMP_NUM_THREADS says what each is to have.
[[nodiscard]] int threads() noexcept;

/// From the first rank to all others; nothing happens to one alone. Every rank knows the size.
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

/// Adds up over all ranks on the first one; what the others have afterwards is of no use.
void sum_on_first(double* values, std::size_t size);
/// The largest of all ranks, on the first one.
[[nodiscard]] double largest_on_first(double value);

/// Ends every rank with a message and exit code 1. For what only one of them knows and the others would wait for ever.
[[noreturn]] void end_all(const char* message);

/// What a rank other than the first has of a problem.
class Part {
 public:
  virtual ~Part() = default;
  /// Takes part in what the first rank has just begun.
  virtual void follow(Order order) = 0;
};

/// The first rank's hold on the others' parts of one problem. Its life is theirs.
class Lead {
 public:
  /// @param kind  of the parts, for follow_orders(); their maker receives what the first rank sends next
  explicit Lead(int kind);
  ~Lead();
  Lead(const Lead&) = delete;
  Lead& operator=(const Lead&) = delete;

  /// Has every part follow an order while this rank does its own share. An exception that leaves the share ends all
  /// ranks, for the others would wait for the rest of it.
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

/// The life of every rank but the first: makes parts and has them follow orders until the first rank's session ends.
using PartMaker = std::function<std::unique_ptr<Part>()>;
void follow_orders(const std::map<int, PartMaker>& makers);

}  // namespace ranks
}  // namespace touchstone::reference
