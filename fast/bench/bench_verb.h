// `bench` on the command line.
#pragma once

#include "fast/bench/bench.h"

#include <CLI/CLI.hpp>

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

/// Adds the verb to a command line. `options` and `exit_code` must outlive the parse.
void add_bench_verb(CLI::App& app, BenchVerbOptions& options, int& exit_code);

}  // namespace touchstone::bench
