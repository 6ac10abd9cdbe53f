#include <array>
#include <functional>
#include <string>
#include <utility>

#include "anthesis/exchange/species_file.h"
#include "species_table.h"

namespace anthesis {
namespace {

using species_table::Choices;
using species_table::Count;
using species_table::describe;
using species_table::Layout;
using species_table::Limits;
using species_table::NameOf;
using species_table::Need;
using species_table::PointsRule;
using species_table::Table;

std::string toml_text(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      result += "\\u00";
      result += kDigits[byte >> 4];
      result += kDigits[byte & 15];
    } else {
      result += c;
    }
  }
  return result + '"';
}

template <class List, class ToText>
std::string toml_list(const List& list, const ToText& to_element) {
  std::string result = "[";
  for (const auto& element : list) {
    result += (result.size() > 1 ? ", " : "") + to_element(element);
  }
  return result + ']';
}

std::string toml_pair(Vec2 point) {
  return '[' + to_text(point.x) + ", " + to_text(point.y) + ']';
}

std::string toml_section(const std::vector<SectionPoint>& section) {
  return toml_list(section, [](const SectionPoint& point) {
    return '[' + to_text(point.across) + ", " + to_text(point.up) +
           (point.forward == 0.0 ? "" : ", " + to_text(point.forward)) + ']';
  });
}

template <class T>
std::string values_of(const T& object, const char* separator);

/// Writes the values of one table, those that TOML wants before any table within it. `separator` ends each.
template <class T>
class ValueWriter {
 public:
  ValueWriter(const T& object, const char* separator) : object_(object), separator_(separator) {}

  std::string result;

  template <class Member>
  void text(const char* key, Member member, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](const std::string& text) { return toml_text(text); });
  }
  template <class Member>
  void name(const char* key, Member member, NameOf, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](const std::string& text) { return toml_text(text); });
  }
  template <class Member>
  void number(const char* key, Member member, const Limits&, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](double number) { return to_text(number); });
  }
  template <class Member>
  void integer(const char* key, Member member, int, int, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](int number) { return std::to_string(number); });
  }
  template <class Member>
  void choice(const char* key, Member member, Choices choices, const char*) {
    value(key, member, Need::kOptional,
          [&](auto chosen) { return toml_text(choices[static_cast<std::size_t>(chosen)]); });
  }
  template <class Member>
  void vector(const char* key, Member member, const Limits&, const char*) {
    value(key, member, Need::kOptional, [](Vec3 v) { return toml_list(std::array{v.x, v.y, v.z}, to_text); });
  }
  template <class Member>
  void flag(const char* key, Member member, const char*) {
    value(key, member, Need::kOptional, [](bool flag) { return std::string(flag ? "true" : "false"); });
  }
  template <class Member>
  void range(const char* key, Member member, const Limits&, const char*) {
    value(key, member, Need::kOptional, [](const Range& range) { return toml_pair({range[0], range[1]}); });
  }
  template <class Member>
  void whole_range(const char* key, Member member, int, int, const char*) {
    value(key, member, Need::kOptional, [](const std::array<int, 2>& range) {
      return toml_pair({static_cast<double>(range[0]), static_cast<double>(range[1])});
    });
  }
  void preset(const char*, const char*, const char*) {}  // the parameters themselves are written
  template <class Member>
  void numbers(const char* key, Member member, const Limits&, Count, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](const std::vector<double>& list) { return toml_list(list, to_text); });
  }
  template <class Member>
  void points(const char* key, Member member, const PointsRule&, const char*, Need need = Need::kOptional) {
    value(key, member, need, [](const std::vector<Vec2>& list) { return toml_list(list, toml_pair); });
  }
  template <class Member>
  void colour(const char* key, Member member, const char*) {
    value(key, member, Need::kOptional, [](const std::optional<Colour>& colour) { return toml_text(to_hex(*colour)); });
  }
  template <class Member>
  void stops(const char* key, Member member, Count, const char*, Need) {
    const std::vector<ColourStop>& stops = std::invoke(member, object_);
    if (stops.size() == 1 && stops[0].at == 0.0) {
      put(key, toml_text(to_hex(stops[0].colour)));
    } else {
      put(key, toml_list(stops, [](const ColourStop& stop) {
            return '[' + to_text(stop.at) + ", " + toml_text(to_hex(stop.colour)) + ']';
          }));
    }
  }
  template <class Member>
  void sections(const char* one, const char* many, Member member, const char*) {
    const std::vector<std::vector<SectionPoint>>& sections = std::invoke(member, object_);
    if (sections.size() == 1) {
      put(one, toml_section(sections[0]));
    } else if (!sections.empty()) {
      put(many, toml_list(sections, toml_section));
    }
  }
  template <class Member>
  void table(const char* key, Member member, Layout layout, const char*, Need = Need::kOptional) {
    if (layout == Layout::kInline) {
      std::string values = values_of(std::invoke(member, object_), ", ");
      if (!values.empty()) {
        values.resize(values.size() - 2);
        put(key, "{ " + values + " }");
      }
    }
  }
  template <class Member>
  void option(const char*, Member, const char*) {}
  template <class Member>
  void list(const char*, Member, Count, const char*, Need = Need::kOptional) {}
  template <class Member>
  void named(const char*, Member, Count, const char*, Need) {}

 private:
  void put(const char* key, const std::string& text) { result += std::string(key) + " = " + text + separator_; }

  template <class Member, class ToText>
  void value(const char* key, Member member, Need need, const ToText& to_value) {
    const std::string text = shown(std::invoke(member, object_), to_value);
    if (need == Need::kRequired || text != shown(std::invoke(member, defaults()), to_value)) {
      put(key, text);
    }
  }
  static const T& defaults() {
    static const T value = {};
    return value;
  }
  template <class Value, class ToText>
  static std::string shown(const Value& value, const ToText& to_value) {
    if constexpr (requires { value.has_value(); }) {
      return value.has_value() ? to_value(value) : std::string();
    } else {
      return to_value(value);
    }
  }

  const T& object_;
  const char* separator_;
};

template <class T>
std::string values_of(const T& object, const char* separator) {
  ValueWriter<T> writer(object, separator);
  describe(writer, Table<T>{});
  return std::move(writer.result);
}

/// Writes the tables within one table, each with its header, its values and the tables within it.
template <class T>
class TableWriter {
 public:
  TableWriter(const T& object, std::string path, std::string& out)
      : object_(object), path_(std::move(path)), out_(out) {}

  // clang-format off
  template <class... R> void text(R&&...) {}
  template <class... R> void name(R&&...) {}
  template <class... R> void number(R&&...) {}
  template <class... R> void integer(R&&...) {}
  template <class... R> void choice(R&&...) {}
  template <class... R> void vector(R&&...) {}
  template <class... R> void flag(R&&...) {}
  template <class... R> void range(R&&...) {}
  template <class... R> void whole_range(R&&...) {}
  template <class... R> void preset(R&&...) {}
  template <class... R> void numbers(R&&...) {}
  template <class... R> void points(R&&...) {}
  template <class... R> void colour(R&&...) {}
  template <class... R> void stops(R&&...) {}
  template <class... R> void sections(R&&...) {}
  // clang-format on

  template <class Member>
  void table(const char* key, Member member, Layout layout, const char*, Need need = Need::kOptional) {
    if (layout == Layout::kOwnTable) {
      using Part = std::remove_cvref_t<decltype(std::invoke(member, object_))>;
      const Part& part = std::invoke(member, object_);
      if (need == Need::kRequired || whole(part) != whole(Part{})) {
        write('[' + path_of(key) + ']', path_of(key), part);
      }
    }
  }
  template <class Member>
  void option(const char* key, Member member, const char*) {
    if (const auto& part = std::invoke(member, object_)) {
      write('[' + path_of(key) + ']', path_of(key), *part);
    }
  }
  template <class Member>
  void list(const char* key, Member member, Count, const char*, Need = Need::kOptional) {
    for (const auto& element : std::invoke(member, object_)) {
      write("[[" + path_of(key) + "]]", path_of(key), element);
    }
  }
  template <class Member>
  void named(const char* key, Member member, Count, const char*, Need) {
    for (const auto& element : std::invoke(member, object_)) {
      const std::string path = path_of(key) + '.' + element.name;
      write('[' + path + ']', path, element);
    }
  }

 private:
  std::string path_of(const char* key) const { return path_.empty() ? key : path_ + '.' + key; }

  template <class Part>
  void write(const std::string& header, const std::string& path, const Part& part) {
    out_ += '\n' + header + '\n' + values_of(part, "\n");
    TableWriter<Part> writer(part, path, out_);
    describe(writer, Table<Part>{});
  }

  template <class Part>
  static std::string whole(const Part& part) {
    std::string text = values_of(part, "\n");
    TableWriter<Part> writer(part, "", text);
    describe(writer, Table<Part>{});
    return text;
  }

  const T& object_;
  std::string path_;
  std::string& out_;
};

}  // namespace

std::string write_species(const Species& species) {
  std::string text = "#:schema ./species.schema.json\n" + values_of(species, "\n");
  TableWriter<Species> writer(species, "", text);
  describe(writer, Table<Species>{});
  return text;
}

}  // namespace anthesis
