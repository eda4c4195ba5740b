#include "scene/response/response_file.h"

#include "scene/base/error.h"
#include "scene/base/hash.h"
#include "scene/base/input.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>

namespace touchstone::scene {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

// "what it is, checksum, line feed, content". Content: the identity's hash, counts, numbers.
constexpr std::string_view magic = "touchstone response 4: m, m/N, 1/N\n";
constexpr std::size_t hash_size = 32;
constexpr InputKind response_input{"a response file", std::uintmax_t{2} << 30};

struct Counts {
  std::int64_t loads_0 = 0, loads_1 = 0, friction = 0, ball = 0, rest_points = 0, unknowns = 0;
};

class Writer {
 public:
  template <class Derived>
  void add(const Eigen::PlainObjectBase<Derived>& matrix) {
    bytes.append(reinterpret_cast<const char*>(matrix.data()),
                 static_cast<std::size_t>(matrix.size()) * sizeof *matrix.data());
  }
  std::string bytes;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}
  template <class Derived>
  void take(Eigen::PlainObjectBase<Derived>& matrix, Eigen::Index rows, Eigen::Index cols) {
    matrix.resize(rows, cols);
    take(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof *matrix.data());
    if (!matrix.allFinite()) throw InputError("it holds a number that is not finite");
  }
  void take(void* to, std::size_t count) {
    if (count > left_.size()) throw InputError("it is cut short");
    std::memcpy(to, left_.data(), count);
    left_.remove_prefix(count);
  }
  [[nodiscard]] std::size_t left() const noexcept { return left_.size(); }

 private:
  std::string_view left_;
};

}  // namespace

std::filesystem::path response_path(const std::filesystem::path& store, const std::string& identity) {
  return store / "response" / (hash_text(identity) + ".response");
}

std::string response_bytes(const Response& response, const std::string& identity) {
  const LoadGrid& grid = response.grid;
  const Counts counts{grid.counts[0],      grid.counts[1],         response.loads.friction,
                      response.loads.ball, response.rest_points(), response.unknowns};
  Writer content;
  content.bytes = hash_text(identity);
  content.bytes.append(reinterpret_cast<const char*>(&counts), sizeof counts);
  content.add(grid.middle_m);
  content.add(grid.axes);
  content.add(Eigen::Vector3d(grid.spacing_m[0], grid.spacing_m[1], response.interpolation_rel));
  content.add(grid.points_m);
  content.add(grid.normals);
  content.add(response.own_m_per_n);
  content.add(response.tilt_per_n);
  content.add(response.smooth_m_per_n);
  return std::string(magic) + hash_text(content.bytes) + '\n' + content.bytes;
}

Response response_from(const std::string& bytes, const std::string& identity) {
  const std::size_t head = magic.size() + hash_size + 1;
  if (!bytes.starts_with(magic.substr(0, magic.find(' ', magic.find(' ') + 1) + 1))) {
    throw InputError("it is no response file");
  }
  if (!bytes.starts_with(magic)) throw InputError("it is a response file of another version");
  if (bytes.size() < head) throw InputError("it is cut short");
  const std::string_view content = std::string_view(bytes).substr(head);
  if (std::string_view(bytes).substr(magic.size(), hash_size) != hash_text(content)) {
    throw InputError("its checksum is wrong: it was cut short or altered");
  }
  if (!content.starts_with(hash_text(identity))) throw InputError("it is of another body, grid or surface");
  Reader reader(content.substr(hash_size));
  Counts counts;
  reader.take(&counts, sizeof counts);
  constexpr std::int64_t most = 1 << 24;
  for (const std::int64_t count : {counts.loads_0, counts.loads_1, counts.rest_points}) {
    if (count < 1 || count > most) throw InputError("it has invalid counts");
  }
  if ((counts.friction | counts.ball | 1) != 1) throw InputError("it has invalid counts");
  Response out;
  out.unknowns = static_cast<int>(counts.unknowns);
  out.grid.counts = {static_cast<int>(counts.loads_0), static_cast<int>(counts.loads_1)};
  const std::int64_t n = counts.loads_0 * counts.loads_1;
  if (n > most) throw InputError("it has invalid counts");
  out.loads = {counts.friction == 1, counts.ball == 1};
  const std::int64_t columns = out.loads.columns(static_cast<int>(n));
  const auto needed = static_cast<std::size_t>(n) * 8 * sizeof(double) +
                      static_cast<std::size_t>(columns) * 3 * (sizeof(double) + sizeof(float) * counts.rest_points);
  if (reader.left() != needed + 15 * sizeof(double)) throw InputError("its size and its counts differ");
  Eigen::Vector3d spacing_m;
  reader.take(out.grid.middle_m, 3, 1);
  reader.take(out.grid.axes, 3, 3);
  reader.take(spacing_m, 3, 1);
  out.interpolation_rel = spacing_m[2];
  out.grid.spacing_m = {spacing_m[0], spacing_m[1]};
  reader.take(out.grid.points_m, 3, n);
  reader.take(out.grid.normals, 3, n);
  reader.take(out.own_m_per_n, 3, columns);
  reader.take(out.tilt_per_n, 2, n);
  reader.take(out.smooth_m_per_n, 3 * counts.rest_points, columns);
  return out;
}

Response read_response(const std::filesystem::path& path, const std::string& identity) {
  const std::string bytes = require_input(path, response_input, "the response");
  try {
    return response_from(bytes, identity);
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

}  // namespace touchstone::scene
