// touchstone: one scene in, one result folder out.
#include "compare/verbs.h"
#include "fast/command_line.h"
#include "fast/live/live_verb.h"
#include "scene/fields.h"

#include <iostream>

using namespace touchstone;

int main(int argc, char** argv) {
  CLI::App app("How wrong a fast contact model is, against a finite-strain reference with error bars.", "touchstone");
  app.add_flag_callback(
      "--scene-reference",
      [] {
        std::cout << scene::scene_reference_markdown();
        throw CLI::Success();
      },
      "print every key of a scene file as a Markdown table");

  fast::VerbOptions options;
  live::LiveOptions live_options;
  compare::ReferenceOptions reference;
  int exit_code = fast::done;
  const auto add = [&](const char* name, const char* what, auto verb) {
    return fast::add_verb(
        app, name, what, options, [&, verb] { return verb(options, reference); }, exit_code);
  };
  const auto add_with_folder = [&](const char* name, const char* what, auto verb) {
    CLI::App* command = add(name, what, verb);
    command->add_option("--out", options.out, std::string("result folder (default out/<scene>-") + name + ")");
    return command;
  };
  const auto add_reference = [&](CLI::App* command) {
    command->add_option("--store", reference.store, "content-addressed reference results, shared by all runs")
        ->capture_default_str();
    auto* levels = command->add_option("--level", reference.levels, "number of meshes, in place of an error")
                       ->check(CLI::Range(1, 9));
    command
        ->add_option("--error", reference.error,
                     "refine until force and shape are known to this, relative (default: the scene's)")
        ->check(CLI::Range(1e-4, 0.5))
        ->excludes(levels);
    command
        ->add_option("--memory-gib", reference.memory_gib, "refine no further than fits (default 80 % of the memory)")
        ->check(CLI::Range(0.1, 1e6));
    command->add_option("--minutes", reference.minutes, "refine no further than can be done in this time")
        ->check(CLI::Range(0.01, 1e6));
  };
  add("plan", "what each side will model for a scene, what it leaves out and why", compare::plan);
  add_with_folder("fast", "the real-time pipeline over the scene's track in virtual time", compare::run_fast);
  add_reference(add_with_folder("reference",
                                "the offline solve; answers from the store, resumes where it was interrupted",
                                compare::run_reference));
  add_reference(
      add_with_folder("compare", "both sides, then force and shape errors: tables, VTK, report", compare::run_compare));
  live::add_live_verb(app, options, live_options, exit_code);
  return fast::run_command_line(app, argc, argv, exit_code);
}
