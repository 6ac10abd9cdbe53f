// The PLY format as its authors describe it: a header of lines, then the values of each element's properties, one
// element after the other.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "mesh_source.h"
#include "text.h"

namespace anthesis::detail {
namespace {

constexpr double kCoordinateLimit = 1e100;
constexpr std::size_t kPartLimit = 1'000'000;
constexpr std::size_t kHeaderLimit = 1 << 20;  // bytes

enum class Encoding { kAscii, kLittle, kBig };

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::optional<Type> type_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> kNames = {{{"char", Type::kInt8},
                                                                         {"uchar", Type::kUint8},
                                                                         {"short", Type::kInt16},
                                                                         {"ushort", Type::kUint16},
                                                                         {"int", Type::kInt32},
                                                                         {"uint", Type::kUint32},
                                                                         {"float", Type::kFloat},
                                                                         {"double", Type::kDouble},
                                                                         {"int8", Type::kInt8},
                                                                         {"uint8", Type::kUint8},
                                                                         {"int16", Type::kInt16},
                                                                         {"uint16", Type::kUint16},
                                                                         {"int32", Type::kInt32},
                                                                         {"uint32", Type::kUint32},
                                                                         {"float32", Type::kFloat},
                                                                         {"float64", Type::kDouble}}};
  for (const auto& [known, type] : kNames) {
    if (known == name) {
      return type;
    }
  }
  return std::nullopt;
}

std::size_t size_of(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 1;
    case Type::kInt16:
    case Type::kUint16:
      return 2;
    case Type::kInt32:
    case Type::kUint32:
    case Type::kFloat:
      return 4;
    case Type::kDouble:
      return 8;
  }
  return 8;
}

bool is_whole(Type type) {
  return type != Type::kFloat && type != Type::kDouble;
}

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::optional<Type> list_count;  ///< set for a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  const Property* find(std::string_view property) const {
    const auto found = std::find_if(properties.begin(), properties.end(),
                                    [property](const Property& each) { return each.name == property; });
    return found == properties.end() ? nullptr : &*found;
  }
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0;;) {
    at = line.find_first_not_of(" \t", at);
    if (at == std::string_view::npos) {
      return words;
    }
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
  }
  const std::from_chars_result result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

class PlyMesh : public MeshSource {
 public:
  MeshPose pose(std::size_t) const override { return {positions, std::vector<std::uint8_t>(parts.size(), 1)}; }
  std::vector<Vec3> positions;
};

/// Reads one file. A function that returns false has said why in `error`.
class PlyReader {
 public:
  PlyReader(std::string_view bytes, std::string_view file_name, PlyMesh& mesh)
      : bytes_(bytes), file_name_(file_name), mesh_(mesh) {}

  bool read() { return read_header() && check_header() && read_body() && name_parts(); }

  Error error;

 private:
  bool fail(std::string_view place, std::string message, ErrorCode code = ErrorCode::kParse) {
    error = {code, file_name_ + ": " + std::string(place) + ':', std::move(message)};
    return false;
  }
  bool fail_at(std::string_view what, std::uint64_t index, std::string message) {
    return fail(std::string(what) + ' ' + std::to_string(index), std::move(message));
  }

  bool read_header();
  bool read_header_line(std::string_view line, const std::string& place);
  bool check_header();
  bool read_body();
  bool read_vertices(const Element& element);
  bool read_faces(const Element& element);
  bool skip(const Element& element);
  bool name_parts();

  /// The next value of a property. False at the end of the file, or where an ascii file has no such number.
  bool next(Type type, double& value);
  bool next_list_size(const Property& property, std::uint64_t& size);
  bool skip_list(const Property& property);

  /// False if what is left of the file cannot hold so many elements. Keeps memory within a multiple of the file's size.
  bool may_hold(const Element& element) const;

  std::string_view bytes_;
  std::string file_name_;
  PlyMesh& mesh_;
  std::size_t at_ = 0;
  Encoding encoding_ = Encoding::kAscii;
  bool format_known_ = false;
  std::vector<Element> elements_;
  std::map<std::int64_t, std::string> kinds_;
  std::vector<std::array<std::int64_t, 2>> organ_and_kind_;  ///< of each vertex; empty if the file does not say
};

std::string shown(std::string_view text) {
  constexpr std::size_t kMostShown = 40;
  return valid_utf8(one_line(text.substr(0, kMostShown)));
}

bool PlyReader::read_header() {
  for (std::uint64_t number = 1;; ++number) {
    const std::string place = "header line " + std::to_string(number);
    const std::size_t end = bytes_.substr(0, kHeaderLimit).find('\n', at_);
    if (end == std::string_view::npos) {
      return fail(place, bytes_.size() > kHeaderLimit
                             ? "must be within the first " + std::to_string(kHeaderLimit) + " bytes of the file"
                             : "must end; the header ends with the line end_header");
    }
    std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    if (number == 1) {
      if (line != "ply") {
        return fail(place, "must be \"ply\", got \"" + shown(line) + '"');
      }
      continue;
    }
    if (line == "end_header") {
      return format_known_ || fail(place, "must come after a line that states the format");
    }
    if (!read_header_line(line, place)) {
      return false;
    }
  }
}

bool PlyReader::read_header_line(std::string_view line, const std::string& place) {
  const std::vector<std::string_view> words = words_of(line);
  if (words.empty() || words[0] == "obj_info") {
    return true;
  }
  if (words[0] == "comment") {
    // comment kind 3: ray_floret
    std::int64_t kind = 0;
    if (words.size() > 3 && words[1] == "kind" && words[2].ends_with(':') &&
        parse(words[2].substr(0, words[2].size() - 1), kind)) {
      kinds_[kind] = valid_utf8(one_line(line.substr(static_cast<std::size_t>(words[3].data() - line.data()))));
    }
    return true;
  }
  if (words[0] == "format") {
    constexpr std::array<std::string_view, 3> kFormats = {"ascii", "binary_little_endian", "binary_big_endian"};
    const auto found = words.size() > 1 ? std::find(kFormats.begin(), kFormats.end(), words[1]) : kFormats.end();
    if (words.size() != 3 || found == kFormats.end() || words[2] != "1.0") {
      return fail(place, "must be format ascii, binary_little_endian or binary_big_endian, and 1.0, got \"" +
                             shown(line) + '"');
    }
    encoding_ = static_cast<Encoding>(found - kFormats.begin());
    format_known_ = true;
    return true;
  }
  if (words[0] == "element") {
    Element element;
    if (words.size() != 3 || !parse(words[2], element.count)) {
      return fail(place, "must be element NAME COUNT, got \"" + shown(line) + '"');
    }
    element.name = words[1];
    elements_.push_back(std::move(element));
    return true;
  }
  if (words[0] == "property") {
    if (elements_.empty()) {
      return fail(place, "must come after the element it belongs to");
    }
    const bool list = words.size() == 5 && words[1] == "list";
    const std::optional<Type> type = list                ? type_named(words[3])
                                     : words.size() == 3 ? type_named(words[1])
                                                         : std::nullopt;
    const std::optional<Type> count = list ? type_named(words[2]) : std::nullopt;
    if (!type || (list && !count)) {
      return fail(place, "must be property TYPE NAME or property list TYPE TYPE NAME, got \"" + shown(line) + '"');
    }
    if (count && !is_whole(*count)) {
      return fail(place, "must count its list in whole numbers, got \"" + shown(line) + '"');
    }
    elements_.back().properties.push_back({std::string(words.back()), *type, count});
    return true;
  }
  return fail(place, "must begin with format, comment, element or property, got \"" + shown(line) + '"');
}

bool PlyReader::check_header() {
  int vertices = 0;
  int faces = 0;
  for (const Element& element : elements_) {
    if (element.name == "vertex") {
      ++vertices;
      for (const char* name : {"x", "y", "z"}) {
        const Property* coordinate = element.find(name);
        if (coordinate == nullptr || coordinate->list_count) {
          return fail("header", std::string("must give each vertex a number ") + name);
        }
      }
      if (element.count > kMeshVertexLimit) {
        return fail(
            "header",
            "must have at most " + std::to_string(kMeshVertexLimit) + " vertices, got " + std::to_string(element.count),
            ErrorCode::kTooLarge);
      }
    } else if (element.name == "face") {
      ++faces;
      const Property* indices = element.find("vertex_indices");
      indices = indices != nullptr ? indices : element.find("vertex_index");
      if (indices == nullptr || !indices->list_count || !is_whole(indices->type)) {
        return fail("header", "must give each face a list vertex_indices of whole numbers");
      }
      if (element.count > kMeshTriangleLimit) {
        return fail(
            "header",
            "must have at most " + std::to_string(kMeshTriangleLimit) + " faces, got " + std::to_string(element.count),
            ErrorCode::kTooLarge);
      }
    }
  }
  if (vertices != 1 || faces != 1) {
    return fail("header", "must have one element vertex and one element face");
  }
  return true;
}

bool PlyReader::may_hold(const Element& element) const {
  std::uint64_t least = 0;  // bytes for each
  for (const Property& property : element.properties) {
    // Each value of an ascii file is a digit and a blank.
    least += encoding_ == Encoding::kAscii ? 2 : size_of(property.list_count.value_or(property.type));
  }
  // The last value needs no blank.
  return least == 0 || element.count <= (bytes_.size() - at_ + 1) / least;
}

bool PlyReader::next(Type type, double& value) {
  if (encoding_ == Encoding::kAscii) {
    const std::size_t begin = bytes_.find_first_not_of(" \t\r\n", at_);
    if (begin == std::string_view::npos) {
      return false;
    }
    at_ = std::min(bytes_.find_first_of(" \t\r\n", begin), bytes_.size());
    const std::string_view text = bytes_.substr(begin, at_ - begin);
    if (type == Type::kFloat) {
      // What a float's text means is the float, not the double nearest to the text.
      float single = 0.0f;
      if (parse(text, single)) {
        value = single;
        return true;
      }
      // What a float cannot hold, because it is too near to zero or too far.
      if (!parse(text, value)) {
        return false;
      }
      value = std::fabs(value) < 1.0 ? 0.0 : std::copysign(HUGE_VAL, value);
      return true;
    }
    return parse(text, value) && (!is_whole(type) || value == std::floor(value));
  }
  const std::size_t size = size_of(type);
  if (bytes_.size() - at_ < size) {
    return false;
  }
  std::array<char, 8> raw = {};
  std::memcpy(raw.data(), bytes_.data() + at_, size);
  at_ += size;
  if (encoding_ == Encoding::kBig) {
    std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
  }
  const auto as = [&raw]<class Number>(Number number) {
    std::memcpy(&number, raw.data(), sizeof number);
    return static_cast<double>(number);
  };
  switch (type) {
    case Type::kInt8:
      value = as(std::int8_t{});
      break;
    case Type::kUint8:
      value = as(std::uint8_t{});
      break;
    case Type::kInt16:
      value = as(std::int16_t{});
      break;
    case Type::kUint16:
      value = as(std::uint16_t{});
      break;
    case Type::kInt32:
      value = as(std::int32_t{});
      break;
    case Type::kUint32:
      value = as(std::uint32_t{});
      break;
    case Type::kFloat:
      value = as(float{});
      break;
    case Type::kDouble:
      value = as(double{});
      break;
  }
  return true;
}

bool PlyReader::next_list_size(const Property& property, std::uint64_t& size) {
  double value = 0.0;
  if (!next(*property.list_count, value) || !(value >= 0.0 && value <= 4294967295.0)) {
    return false;
  }
  size = static_cast<std::uint64_t>(value);
  return true;
}

bool PlyReader::skip_list(const Property& property) {
  std::uint64_t size = 0;
  if (!next_list_size(property, size)) {
    return false;
  }
  double value = 0.0;
  for (std::uint64_t i = 0; i < size; ++i) {
    if (!next(property.type, value)) {  // the end of the file, at the latest, ends this
      return false;
    }
  }
  return true;
}

bool PlyReader::read_body() {
  for (const Element& element : elements_) {
    if (!may_hold(element)) {
      return fail("header", "must announce what the file holds, got " + std::to_string(element.count) + " of " +
                                shown(element.name) + " and " + std::to_string(bytes_.size() - at_) +
                                " bytes left for them");
    }
    if (!(element.name == "vertex" ? read_vertices(element)
          : element.name == "face" ? read_faces(element)
                                   : skip(element))) {
      return false;
    }
  }
  return true;
}

constexpr const char* kEndsEarly = "must be whole: a number is missing or is none";

bool PlyReader::read_vertices(const Element& element) {
  enum Role { kX, kY, kZ, kOrgan, kKind, kNone };
  std::vector<Role> roles;
  bool has_organ = false;
  for (const Property& property : element.properties) {
    constexpr std::array<std::string_view, 5> kRoles = {"x", "y", "z", "organ", "kind"};
    const auto found = std::find(kRoles.begin(), kRoles.end(), property.name);
    // Of properties with one name the first counts, as find() above.
    const bool taken = element.find(property.name) != &property;
    Role role = found == kRoles.end() || taken ? kNone : static_cast<Role>(found - kRoles.begin());
    if ((role == kOrgan || role == kKind) && (property.list_count || !is_whole(property.type))) {
      role = kNone;  // somebody else's property of that name
    }
    has_organ = has_organ || role == kOrgan;
    roles.push_back(role);
  }
  mesh_.vertex_count = element.count;
  mesh_.positions.resize(element.count);
  if (has_organ) {
    organ_and_kind_.resize(element.count, {0, -1});
  }
  for (std::size_t i = 0; i < element.count; ++i) {
    for (std::size_t k = 0; k < roles.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.list_count) {
        if (!skip_list(property)) {
          return fail_at("vertex", i, kEndsEarly);
        }
        continue;
      }
      double value = 0.0;
      if (!next(property.type, value)) {
        return fail_at("vertex", i, kEndsEarly);
      }
      if (roles[k] <= kZ) {
        if (!(std::fabs(value) <= kCoordinateLimit)) {
          return fail_at("vertex", i, property.name + " must be within -1e100 to 1e100, got " + to_text(value));
        }
        (roles[k] == kX ? mesh_.positions[i].x : roles[k] == kY ? mesh_.positions[i].y : mesh_.positions[i].z) = value;
      } else if (roles[k] != kNone && has_organ) {
        // Whole numbers that an ascii file states may be of any size.
        const double most = 9007199254740992.0;
        organ_and_kind_[i][roles[k] - kOrgan] = static_cast<std::int64_t>(std::clamp(value, -most, most));
      }
    }
  }
  return true;
}

bool PlyReader::read_faces(const Element& element) {
  const std::size_t vertex_count =
      std::find_if(elements_.begin(), elements_.end(), [](const Element& e) { return e.name == "vertex"; })->count;
  const Property* indices = element.find("vertex_indices");
  indices = indices != nullptr ? indices : element.find("vertex_index");
  mesh_.triangles.reserve(element.count);
  for (std::size_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      if (&property != indices) {
        double value = 0.0;
        if (!(property.list_count ? skip_list(property) : next(property.type, value))) {
          return fail_at("face", i, kEndsEarly);
        }
        continue;
      }
      std::uint64_t size = 0;
      if (!next_list_size(property, size)) {
        return fail_at("face", i, kEndsEarly);
      }
      if (size < 3) {
        return fail_at("face", i, "must have 3 vertices or more, got " + std::to_string(size));
      }
      Triangle triangle = {};
      for (std::uint64_t k = 0; k < size; ++k) {
        double value = 0.0;
        if (!next(property.type, value)) {
          return fail_at("face", i, kEndsEarly);
        }
        if (!(value >= 0.0 && value < static_cast<double>(vertex_count))) {
          return fail_at("face", i,
                         "must name vertices below " + std::to_string(vertex_count) + ", got " + to_text(value));
        }
        const auto vertex = static_cast<std::uint32_t>(value);
        if (k < 2) {
          triangle[k] = vertex;
          continue;
        }
        triangle[2] = vertex;
        if (mesh_.triangles.size() == kMeshTriangleLimit) {
          return fail("face " + std::to_string(i),
                      "must be within the first " + std::to_string(kMeshTriangleLimit) + " triangles",
                      ErrorCode::kTooLarge);
        }
        mesh_.triangles.push_back(triangle);
        triangle[1] = vertex;  // the next of the fan
      }
    }
  }
  return true;
}

bool PlyReader::skip(const Element& element) {
  if (element.properties.empty()) {
    return true;
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      double value = 0.0;
      if (!(property.list_count ? skip_list(property) : next(property.type, value))) {
        return fail_at(shown(element.name), i, kEndsEarly);
      }
    }
  }
  return true;
}

bool PlyReader::name_parts() {
  mesh_.part_of_triangle.resize(mesh_.triangles.size());
  if (organ_and_kind_.empty()) {
    mesh_.parts = {"mesh"};
    return true;
  }
  // The parts in order of organ: what else decides the order of a report?
  std::map<std::array<std::int64_t, 2>, std::uint32_t> part_of;
  for (const Triangle& triangle : mesh_.triangles) {
    part_of[organ_and_kind_[triangle[0]]] = 0;
    if (part_of.size() > kPartLimit) {
      return fail("vertices", "must be of at most " + std::to_string(kPartLimit) + " organs", ErrorCode::kTooLarge);
    }
  }
  for (auto& [organ_and_kind, part] : part_of) {
    part = static_cast<std::uint32_t>(mesh_.parts.size());
    const auto [organ, kind] = organ_and_kind;
    const auto kind_name = kinds_.find(kind);
    mesh_.parts.push_back(organ == 0 && kind < 0 ? "plant"
                                                 : (kind_name == kinds_.end() ? "organ" : kind_name->second) + '.' +
                                                       std::to_string(organ));
  }
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
    mesh_.part_of_triangle[i] = part_of[organ_and_kind_[mesh_.triangles[i][0]]];
  }
  return true;
}

}  // namespace

Expected<std::unique_ptr<const MeshSource>> read_ply(std::string_view bytes, std::string_view file_name) {
  auto mesh = std::make_unique<PlyMesh>();
  PlyReader reader(bytes, file_name, *mesh);
  if (!reader.read()) {
    return unexpected(reader.error);
  }
  return mesh;
}

}  // namespace anthesis::detail
