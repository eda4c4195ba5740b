// Response files: written by the reference's side, read by the real-time side.
#pragma once

#include "scene/response/response.h"

#include <filesystem>
#include <string>

namespace touchstone::scene {

/// The path of the file of an identity, named by its hash, in a folder of content-addressed results.
[[nodiscard]] std::filesystem::path response_path(const std::filesystem::path& store, const std::string& identity);

/// A file's bytes: a versioned header with units, a checksum of all that follows it, the identity, and numbers in SI
/// units, little-endian.
[[nodiscard]] std::string response_bytes(const Response& response, const std::string& identity);

/// @throws InputError when the bytes are no response file, of another version, cut short, altered, or of another
///         identity than the one expected
[[nodiscard]] Response response_from(const std::string& bytes, const std::string& identity);

/// Reads a file. @throws InputError likewise, with the file's path
[[nodiscard]] Response read_response(const std::filesystem::path& path, const std::string& identity);

}  // namespace touchstone::scene
