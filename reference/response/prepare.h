// The response of a scene's body, from the store or computed and kept there.
#pragma once

#include "reference/response/smooth_response.h"
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

/// Reads the response's file where it is there and right; otherwise computes it and writes the file. While it computes,
/// the finished columns are kept in a file beside it, every few seconds and when the computation is stopped, with a
/// checksum; the next call goes on with them.
/// @param surface   the scene's rest surface
/// @param store     folder of content-addressed results; the file is in its subfolder "response"
/// @param progress  as of smooth_response(); not called where the file is there
/// @throws scene::InputError with the reason where the scene has no load grid, and as smooth_response();
///         std::filesystem::filesystem_error
[[nodiscard]] Prepared prepare_response(const scene::Scene& scene, const scene::Surface& surface,
                                        const std::filesystem::path& store,
                                        const std::function<void(const SmoothProgress&)>& progress = {});

}  // namespace touchstone::reference
