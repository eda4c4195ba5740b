#include "reference/linear/ranks.h"

#include "reference/linear/threads.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace touchstone::reference::ranks {
namespace {

struct World {
  int count = 1, own = 0, on_this_machine = 1, threads = 0;
  int parts_made = 0;
};
World world;

/// The first rank's order to the others between collective operations.
struct Message {
  enum Kind { make, order, drop, end } kind;
  int part;
  int what;  ///< make: the kind of part; order: which
};

/// MPI counts in int, and a message may be larger than 2 GB.
template <class Piece>
void in_pieces(std::size_t size, const Piece& piece) {
  constexpr std::size_t most = std::size_t{1} << 28;
  for (std::size_t begin = 0; begin < size; begin += most) {
    piece(begin, static_cast<int>(std::min(most, size - begin)));
  }
}

void say(Message message) {
  MPI_Request request;
  MPI_Ibcast(&message, sizeof message, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
}

/// Waits asleep: the first rank may compute alone for long and may need this processor.
Message hear() {
  Message message{};
  MPI_Request request;
  MPI_Ibcast(&message, sizeof message, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  constexpr std::chrono::microseconds longest(1000);
  std::chrono::microseconds pause(10);
  for (int here = 0;;) {
    MPI_Test(&request, &here, MPI_STATUS_IGNORE);
    if (here) return message;
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, longest);
  }
}

/// Open MPI's mpirun and PMIx launchers such as srun set these for every process. Checking them first keeps an ordinary
/// start free of MPI.
bool launched_with_others() { return std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMIX_RANK"); }

/// A processor that n ranks may use counts as 1 / n for each of them.
int fair_threads(MPI_Comm machine, int ranks_there) {
  if (std::getenv("OMP_NUM_THREADS")) return threads_to_use();
  cpu_set_t own;
  CPU_ZERO(&own);
  if (sched_getaffinity(0, sizeof own, &own) != 0) return std::max(1, threads_to_use() / ranks_there);
  std::vector<cpu_set_t> all(ranks_there);
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, machine);
  double share = 0.0;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(processor, &own)) continue;
    share += 1.0 / static_cast<double>(std::count_if(all.begin(), all.end(),
                                                     [&](const cpu_set_t& set) { return CPU_ISSET(processor, &set); }));
  }
  return std::max(1, static_cast<int>(std::lround(share)));
}

}  // namespace

Session::Session() {
  if (!launched_with_others()) return;
  int level = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_size(MPI_COMM_WORLD, &world.count);
  MPI_Comm_rank(MPI_COMM_WORLD, &world.own);
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, world.own, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &world.on_this_machine);
  world.threads = fair_threads(machine, world.on_this_machine);
  MPI_Comm_free(&machine);
  if (first()) return;
  // Such a signal reaches every rank. The first one ends its step and then stops the others.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
}

Session::~Session() {
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (!initialized) return;
  if (first() && count() > 1) say({Message::end, 0, 0});
  MPI_Finalize();
  world = {};
}

int count() noexcept { return world.count; }
int own() noexcept { return world.own; }
int on_this_machine() noexcept { return world.on_this_machine; }
int threads() noexcept { return world.threads > 0 ? world.threads : threads_to_use(); }

void send(const void* data, std::size_t bytes) { receive(const_cast<void*>(data), bytes); }

void receive(void* data, std::size_t bytes) {
  if (count() == 1) return;
  in_pieces(bytes, [&](std::size_t begin, int size) {
    MPI_Bcast(static_cast<char*>(data) + begin, size, MPI_BYTE, 0, MPI_COMM_WORLD);
  });
}

void sum_on_first(double* values, std::size_t size) {
  if (count() == 1) return;
  in_pieces(size, [&](std::size_t begin, int piece) {
    MPI_Reduce(first() ? MPI_IN_PLACE : values + begin, values + begin, piece, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
  });
}

double largest_on_first(double value) {
  if (count() == 1) return value;
  double largest = value;
  MPI_Reduce(&value, &largest, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  return largest;
}

void end_all(const char* message) {
  std::fprintf(stderr, "rank %d of %d cannot continue: %s\n", own() + 1, count(), message);
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  std::abort();
}

Lead::Lead(int kind) : part_(world.parts_made++) { say({Message::make, part_, kind}); }
Lead::~Lead() { say({Message::drop, part_, 0}); }
void Lead::give(Order order) const { say({Message::order, part_, static_cast<int>(order)}); }

void follow_orders(const std::map<int, PartMaker>& makers) {
  std::map<int, std::unique_ptr<Part>> parts;
  try {
    for (;;) {
      const Message message = hear();
      switch (message.kind) {
        case Message::make:
          parts[message.part] = makers.at(message.what)();
          break;
        case Message::order:
          parts.at(message.part)->follow(static_cast<Order>(message.what));
          break;
        case Message::drop:
          parts.erase(message.part);
          break;
        case Message::end:
          return;
      }
    }
  } catch (const std::exception& error) {
    end_all(error.what());
  }
}

}  // namespace touchstone::reference::ranks
