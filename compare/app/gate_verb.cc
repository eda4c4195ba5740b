#include "compare/app/gate_verb.h"

#include "compare/gate/gate_limits.h"
#include "compare/gate/gate_page.h"
#include "compare/gate/gate_report.h"
#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

namespace touchstone::compare {
namespace {

void print(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::cout << line << '\n';
}

/// New reference data and accepted values are to be reviewed gate by gate, so the gates must be named.
void require_names(const GateOptions& options, const char* flag) {
  if (options.names.empty())
    throw scene::InputError(std::string(flag) + ": expected the gates' names, FILE or FILE.GATE");
}

}  // namespace

int gate(const GateOptions& options, const std::string& command) {
  for (const std::string& name : options.names) {
    // If a file was given in place of a name, loading it reports what kind of file it is, unless it is a gate file.
    if (std::filesystem::is_regular_file(name)) (void)load_gate_file(name);
  }
  const GateFolder folder = load_gates(options.folder);
  require_known(folder, options.names);
  if (options.list) {
    for (const GateFile& file : folder.files) {
      std::cout << file.name << ": " << file.title << '\n';
      for (const Gate& one : file.gates) {
        std::cout << fmt::format("  {}.{}: {} within {:g} {}\n", file.name, one.name, one.quantity, one.limit,
                                 one.unit);
      }
    }
    return fast::done;
  }
  if (options.regenerate) {
    require_names(options, "--regenerate");
    print(regenerate(folder, options.names, options.reference, options.quiet));
    return fast::done;
  }
  const std::optional<BaseGates> base =
      options.base.empty() ? std::nullopt : std::optional(base_gates(options.folder, options.base));
  if (options.accept) require_names(options, "--accept");

  const scene::FolderLock lock = scene::prepare_result_folder(options.out);
  fast::ProgressLine line(options.quiet);
  scene::Manifest manifest = scene::make_manifest(scene::Scene{}, command);
  manifest.scene_hash = "none: every gate file names its own";
  manifest.resolved_scene.clear();
  const auto working = [&](const std::string& what) { line.show("gate: " + what, true); };
  const scene::Stopwatch watch;
  std::vector<GateRecord> records = run_gates(folder, options.names, working);
  manifest.times.push_back(watch.read("gates"));
  if (options.accept) {
    line.finish();
    print(accept(folder, records));
    return fast::done;
  }
  std::vector<std::string> faults = hold_limits(folder, base ? &*base : nullptr, today(), records);
  faults.insert(faults.end(), folder.unused.begin(), folder.unused.end());
  std::vector<GateProof> proofs;
  if (options.prove) {
    const scene::Stopwatch proof_watch;
    proofs = prove_gates(folder, records, working);
    manifest.times.push_back(proof_watch.read("proofs"));
  }
  line.finish();
  std::string text = gates_text(records, faults);
  if (options.prove) text += "\n" + proofs_text(proofs);
  for (const GateProof& proof : proofs) {
    if (!proof.holds()) faults.push_back(proof.changed.name() + " is not proved: " + proof.failure);
  }
  scene::write_file(options.out / "table.txt", text);
  scene::write_summary(options.out / "summary.json", gate_report_figures(records, faults));
  scene::write_manifest(options.out / "manifest.json", manifest);
  scene::write_file(options.out / "report.html",
                    gate_page_html(folder, records, faults, proofs, manifest, options.out));
  if (!options.junit.empty()) scene::write_file(options.junit, gates_junit(records, faults));
  std::cout << text << "Report: " << (options.out / "report.html").string() << '\n';
  const bool good = faults.empty() && std::ranges::all_of(records, &GateRecord::passes);
  return good ? fast::done : fast::answer_is_no;
}

void add_gate_verb(fast::Command& program, GateOptions& options) {
  fast::Command verb = program.add("gate", "check accuracy gates; exit 1 when one is red");
  verb.option("NAME", options.names, "gates to check, FILE or FILE.GATE (default all)");
  verb.option("--gates", options.folder, "folder of the gate files").shows_default();
  verb.option("--out", options.out, "result folder").shows_default();
  verb.option("--junit", options.junit, "also write JUnit's XML to this file");
  verb.option("--base", options.base, "commit or branch whose limits may not be widened without a waiver");
  verb.flag("--list", options.list, "print names, quantities and limits; nothing is run");
  verb.prints("--keys", gate_reference_markdown, "print every key of a gate file as Markdown tables");
  verb.flag("--quiet", options.quiet, "no progress, only results and errors");
  const fast::Option prove =
      verb.flag("--prove", options.prove, "also apply every gate's own change; exit 1 unless it turns the gate red");
  const fast::Option regenerate =
      verb.flag("--regenerate", options.regenerate, "solve the reference data of the named gates, and write it");
  const fast::Option accept =
      verb.flag("--accept", options.accept, "write the values of the named drift gates as accepted");
  regenerate.excludes(prove).excludes(accept);
  accept.excludes(prove);
  verb.option("--store", options.reference.store, "for --regenerate: folder of stored reference results")
      .shows_default()
      .needs(regenerate);
  verb.example("gate --junit out/gates.xml --base origin/main");
  verb.action([&options, name = program.program_name()] { return gate(options, name + " gate"); });
}

}  // namespace touchstone::compare
