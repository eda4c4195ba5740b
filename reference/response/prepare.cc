#include "reference/response/prepare.h"

#include "reference/response/smooth_response.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/base/stopwatch.h"
#include "scene/response/response_file.h"

namespace touchstone::reference {

Prepared prepare_response(const scene::Scene& scene, const scene::Surface& surface, const std::filesystem::path& store,
                          const std::function<void()>& begin, const std::function<void(double)>& progress) {
  const scene::FoundGrid found = scene::load_grid(scene);
  if (!found.grid) throw scene::InputError("the response model needs that " + found.why);
  const std::string identity =
      scene::response_identity(scene.body, *found.grid, surface, scene.contact.friction.has_value());
  Prepared out;
  out.file = scene::response_path(store, identity);
  if (std::filesystem::exists(out.file)) {
    try {
      out.response = scene::read_response(out.file, identity);
      return out;
    } catch (const scene::InputError&) {
      // A damaged file is computed anew.
    }
  }
  if (begin) begin();
  const scene::Stopwatch watch;
  const SmoothResponseOptions options{.friction = scene.contact.friction.has_value()};
  out.response = smooth_response(scene.body, *found.grid, surface.points_m, options, progress);
  out.computed = true;
  out.seconds = watch.wall_s();
  scene::require_writable(out.file.parent_path(), "--store");
  scene::write_file(out.file, scene::response_bytes(out.response, identity));
  return out;
}

}  // namespace touchstone::reference
