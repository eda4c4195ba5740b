#include "fast/command_line.h"

#include "scene/build_info.h"
#include "scene/error.h"
#include "scene/first_contact.h"
#include "scene/scene_io.h"

#include <algorithm>
#include <iostream>

namespace touchstone::fast {

std::filesystem::path VerbOptions::folder(const scene::Scene& scene, const std::string& verb) const {
  return out.empty() ? std::filesystem::path("out") / (scene.name + "-" + verb) : out;
}

scene::Scene VerbOptions::load() const {
  scene::Scene scene = scene::load_scene(scene_file, overrides);
  if (const std::string warning = scene::no_contact_warning(scene); !warning.empty())
    std::cerr << "warning: " << scene_file.string() << ": " << warning << '\n';
  return scene;
}

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& what, VerbOptions& options,
                   std::function<int()> action, int& exit_code) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->add_option("SCENE", options.scene_file, "scene file (TOML)")->required();
  verb->add_option("--set", options.overrides, "override a key, such as fast.C_n=0.1; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb->add_flag("--quiet", options.quiet, "no progress, only results and errors");
  verb->footer("Example:\n  " + app.get_name() + " " + name +
               " meshes/scenes/ball-on-cube-press.toml --set fast.formulation=published");
  verb->callback([action = std::move(action), &exit_code] { exit_code = action(); });
  return verb;
}

int run_command_line(CLI::App& app, int argc, char** argv, int& exit_code) {
  app.require_subcommand(1);
  app.set_version_flag("--version",
                       std::string("Touchstone ") + scene::build_info.version + " (" + scene::build_info.commit + ")");
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? done : bad_input;
  } catch (const scene::InputError& error) {
    std::cerr << error.what() << '\n';
    return bad_input;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << error.what() << '\n';
    return bad_input;
  }
}

std::string plan_text(const std::string& title, const scene::Plan& plan) {
  std::size_t width = 0;
  for (const scene::PlanLine& line : plan) width = std::max(width, line.part.size());
  std::string text = title + "\n";
  for (const scene::PlanLine& line : plan) {
    text += std::string(line.modelled ? "  yes  " : "  no   ") + line.part +
            std::string(width - line.part.size() + 2, ' ') + line.reason +
            (line.cost.empty() ? "" : " (" + line.cost + ")") + "\n";
  }
  return text;
}

}  // namespace touchstone::fast
