// `bench` on the command line.
#pragma once

#include "fast/bench/bench.h"
#include "fast/command/command.h"

#include <filesystem>
#include <string>

namespace touchstone::bench {

struct BenchVerbOptions : BenchOptions {
  std::filesystem::path out = "out/bench";
  bool quiet = false;
};

/// Runs the benchmark, prints the tables, leaves summary.json and manifest.json.
/// @param command for the manifest, such as "touchstone-fast bench"
/// @returns done: a missed target is reported, not an error
/// @throws scene::InputError for bad input
int bench_verb(const BenchVerbOptions& options, const std::string& command);

/// Adds the command; its variables must outlive Program::run.
void add_bench_verb(fast::Command& program, BenchVerbOptions& options);

}  // namespace touchstone::bench
