// The response of a scene's body, from the store or computed and kept there.
#pragma once

#include "scene/model/scene.h"
#include "scene/response/response.h"
#include "scene/shape/surface.h"

#include <filesystem>
#include <functional>

namespace touchstone::reference {

struct Prepared {
  scene::Response response;
  std::filesystem::path file;
  bool computed = false;  ///< now; otherwise read
  double seconds = 0.0;   ///< of the computation
};

/// Reads the response's file where it is there and right; otherwise computes it and writes the file.
/// @param surface   the scene's rest surface
/// @param store     folder of content-addressed results; the file is in its subfolder "response"
/// @param begin     called before a computation, once; may be empty
/// @param progress  as of smooth_response()
/// @throws scene::InputError with the reason where the scene has no load grid, and as smooth_response();
///         std::filesystem::filesystem_error
[[nodiscard]] Prepared prepare_response(const scene::Scene& scene, const scene::Surface& surface,
                                        const std::filesystem::path& store, const std::function<void()>& begin = {},
                                        const std::function<void(double)>& progress = {});

}  // namespace touchstone::reference
