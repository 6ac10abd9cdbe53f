#include "anthesis/exchange/species_file.h"

#include <sys/stat.h>
#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "anthesis/base/file.h"
#include "anthesis/base/sha256.h"
#include "species_table.h"
#include "species_toml.h"

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
using species_table::rule_text;
using species_table::Table;

using Position = toml::source_position;

constexpr int kMostNested = 32;    // values within values
constexpr int kMostKeyParts = 16;  // a.b.c has three

/// Other people's text, fit to be quoted in one line of a terminal.
std::string quotable(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string result;
  for (const char c : text.substr(0, kMost)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  while (text.size() > kMost && !result.empty() && (static_cast<unsigned char>(result.back()) & 0xc0) == 0x80) {
    result.pop_back();  // do not end inside a UTF-8 sequence
  }
  return text.size() > kMost ? result + "..." : result;
}

std::string quoted(std::string_view text) {
  return '"' + quotable(text) + '"';
}

/// A node as an error message shows it.
std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string()) {
    return quoted(text->get());
  }
  if (const auto* whole = node.as_integer()) {
    return std::to_string(whole->get());
  }
  if (const auto* real = node.as_floating_point()) {
    return to_text(real->get());
  }
  if (const auto* flag = node.as_boolean()) {
    return flag->get() ? "true" : "false";
  }
  if (const auto* array = node.as_array()) {
    return array->empty() ? "an empty list" : "a list";
  }
  return node.is_table() ? "a table" : "a date or time";
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= species_table::kLongestName &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
         });
}

constexpr const char* kNameRule = "must be a name of at most 64 letters, digits, _ and -";

/// A file being read: the first error, where every key stands, and the names to look up at the end.
class Document {
 public:
  explicit Document(std::string_view file_name) : file_name_(file_name) {}

  bool failed() const { return error_.has_value(); }
  Error take_error() { return std::move(*error_); }

  void fail(ErrorCode code, Position position, std::string_view path, std::string message) {
    if (!error_) {
      error_ = Error{code, place(position) + (path.empty() ? "" : " " + std::string(path)), std::move(message)};
    }
  }
  void refuse(const toml::node& node, std::string_view path, std::string_view rule) {
    fail(ErrorCode::kInvalidParameter, node.source().begin, path, std::string(rule) + ", got " + shown(node));
  }
  void missing(Position position, std::string_view path, std::string_view what) {
    fail(ErrorCode::kInvalidParameter, position, path, std::string(what));
  }

  void remember(std::string path, Position position) { positions_.emplace(std::move(path), position); }

  /// Adds the place to an error of check(Species): that of the key it names, or of the nearest table around it.
  Error with_place(Error error) const {
    for (std::string path = error.where;;) {
      if (const auto found = positions_.find(path); found != positions_.end()) {
        error.where = place(found->second) + ' ' + error.where;
        return error;
      }
      const std::size_t cut = path.find_last_of(".[");
      if (cut == std::string::npos) {
        error.where = place({1, 1}) + (error.where.empty() ? "" : " " + error.where);
        return error;
      }
      path.resize(cut);
    }
  }

  struct Reference {
    NameOf of;
    std::string name;
    std::string path;
    Position position;
  };
  std::vector<Reference> references;

 private:
  std::string place(Position position) const {
    // Tables that only exist through their children, and the file itself, have no place of their own in toml++.
    const Position shown = position ? position : Position{1, 1};
    return file_name_ + ':' + std::to_string(shown.line) + ':' + std::to_string(shown.column) + ':';
  }

  std::string file_name_;
  std::optional<Error> error_;
  std::map<std::string, Position> positions_;
};

std::optional<double> number_of(const toml::node& node) {
  if (const auto* whole = node.as_integer()) {
    return static_cast<double>(whole->get());
  }
  if (const auto* real = node.as_floating_point()) {
    return real->get();
  }
  return std::nullopt;
}

bool read_number(Document& document, const toml::node& node, std::string_view path, const Limits& limits,
                 double& result) {
  const std::optional<double> value = number_of(node);
  if (!value) {
    document.refuse(node, path, "must be a number");
    return false;
  }
  if (!limits.allow(*value)) {
    document.refuse(node, path, rule_text(limits));
    return false;
  }
  result = *value;
  return true;
}

/// The list `node` is, if its length is allowed.
const toml::array* read_list(Document& document, const toml::node& node, std::string_view path, Count count) {
  const toml::array* array = node.as_array();
  if (array == nullptr) {
    document.refuse(node, path, "must be a list");
    return nullptr;
  }
  if (array->size() < count.min || array->size() > count.max) {
    document.fail(array->size() > count.max ? ErrorCode::kTooLarge : ErrorCode::kInvalidParameter, node.source().begin,
                  path,
                  "must have " + std::to_string(count.min) + " to " + std::to_string(count.max) + " elements, got " +
                      std::to_string(array->size()));
    return nullptr;
  }
  return array;
}

std::string indexed(std::string_view path, std::size_t index) {
  return std::string(path) + '[' + std::to_string(index) + ']';
}

bool read_points(Document& document, const toml::node& node, std::string_view path, const PointsRule& rule,
                 std::vector<Vec2>& result) {
  const toml::array* list = read_list(document, node, path, rule.count);
  if (list == nullptr) {
    return false;
  }
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = indexed(path, i);
    const toml::array* pair = list->get(i)->as_array();
    if (pair == nullptr || pair->size() != 2) {
      document.refuse(*list->get(i), where, "must be two numbers [x, y]");
      return false;
    }
    Vec2 point;
    if (!read_number(document, *pair->get(0), indexed(where, 0), rule.x, point.x) ||
        !read_number(document, *pair->get(1), indexed(where, 1), rule.y, point.y)) {
      return false;
    }
    if (rule.ascending && !points.empty() && point.x < points.back().x) {
      document.refuse(*pair->get(0), indexed(where, 0),
                      "must be at least " + to_text(points.back().x) + " as the one before it");
      return false;
    }
    points.push_back(point);
  }
  if (rule.ascending && !rule.one_is_enough && points.front().x == points.back().x) {
    document.refuse(node, path, "must span a range: the first and the last point must differ in x");
    return false;
  }
  result = std::move(points);
  return true;
}

bool read_colour(Document& document, const toml::node& node, std::string_view path, Colour& result) {
  const auto* text = node.as_string();
  const Expected<Colour> colour = text != nullptr ? parse_colour(text->get()) : unexpected(Error{});
  if (!colour) {
    document.refuse(node, path, "must be a colour \"#rrggbb\"");
    return false;
  }
  result = *colour;
  return true;
}

bool read_section(Document& document, const toml::node& node, std::string_view path,
                  std::vector<SectionPoint>& result) {
  const toml::array* list = read_list(document, node, path, species_table::kSectionPoints);
  if (list == nullptr) {
    return false;
  }
  const Limits offset = species_table::within(-100.0, 100.0);
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = indexed(path, i);
    const toml::array* values = list->get(i)->as_array();
    if (values == nullptr || values->size() < 2 || values->size() > 3) {
      document.refuse(*list->get(i), where, "must be [across, up] or [across, up, forward]");
      return false;
    }
    SectionPoint point;
    if (!read_number(document, *values->get(0), indexed(where, 0), species_table::within(0.0, 4.0), point.across) ||
        !read_number(document, *values->get(1), indexed(where, 1), offset, point.up) ||
        (values->size() == 3 && !read_number(document, *values->get(2), indexed(where, 2), offset, point.forward))) {
      return false;
    }
    result.push_back(point);
  }
  return true;
}

/// Collects the keys that a table knows.
struct KeyList {
  std::vector<std::string_view> keys;

  template <class... Rest>
  void add(const char* key, Rest&&...) {
    keys.emplace_back(key);
  }
  // clang-format off
  template <class... R> void text(const char* key, R&&...) { add(key); }
  template <class... R> void name(const char* key, R&&...) { add(key); }
  template <class... R> void number(const char* key, R&&...) { add(key); }
  template <class... R> void integer(const char* key, R&&...) { add(key); }
  template <class... R> void choice(const char* key, R&&...) { add(key); }
  template <class... R> void vector(const char* key, R&&...) { add(key); }
  template <class... R> void flag(const char* key, R&&...) { add(key); }
  template <class... R> void range(const char* key, R&&...) { add(key); }
  template <class... R> void whole_range(const char* key, R&&...) { add(key); }
  template <class... R> void numbers(const char* key, R&&...) { add(key); }
  template <class... R> void points(const char* key, R&&...) { add(key); }
  template <class... R> void colour(const char* key, R&&...) { add(key); }
  template <class... R> void stops(const char* key, R&&...) { add(key); }
  template <class... R> void table(const char* key, R&&...) { add(key); }
  template <class... R> void option(const char* key, R&&...) { add(key); }
  template <class... R> void list(const char* key, R&&...) { add(key); }
  template <class... R> void named(const char* key, R&&...) { add(key); }
  template <class... R> void sections(const char* one, const char* many, R&&...) { add(one), add(many); }
  template <class... R> void preset(const char* like, const char* source, R&&...) { add(like), add(source); }
  // clang-format on
};

/// Reads one table into one object; a visitor of species_table.h.
template <class T>
class TableReader {
 public:
  TableReader(Document& document, const toml::table& table, std::string path, T& object)
      : document_(document), table_(table), path_(std::move(path)), object_(object) {}

  void run() {
    document_.remember(path_, table_.source().begin);
    refuse_unknown_keys();
    if (!document_.failed()) {
      describe(*this, Table<T>{});
    }
  }

  template <class Member>
  void text(const char* key, Member member, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      const auto* value = node->as_string();
      if (value == nullptr) {
        return document_.refuse(*node, where(key), "must be a text");
      }
      if (value->get().size() > species_table::kLongestText) {
        return document_.refuse(*node, where(key), "must be at most 1000 bytes long");
      }
      std::invoke(member, object_) = value->get();
    }
  }

  template <class Member>
  void name(const char* key, Member member, NameOf of, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      const auto* value = node->as_string();
      if (value == nullptr || !is_name(value->get())) {
        return document_.refuse(*node, where(key), kNameRule);
      }
      std::invoke(member, object_) = value->get();
      if (of != NameOf::kNothing) {
        document_.references.push_back({of, value->get(), where(key), node->source().begin});
      }
    }
  }

  template <class Member>
  void number(const char* key, Member member, const Limits& limits, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      read_number(document_, *node, where(key), limits, std::invoke(member, object_));
    }
  }

  template <class Member>
  void integer(const char* key, Member member, int min, int max, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      const auto* value = node->as_integer();
      if (value == nullptr || value->get() < min || value->get() > max) {
        return document_.refuse(*node, where(key),
                                "must be a whole number in [" + std::to_string(min) + ", " + std::to_string(max) + "]");
      }
      std::invoke(member, object_) = static_cast<int>(value->get());
    }
  }

  template <class Member>
  void choice(const char* key, Member member, Choices choices, const char*) {
    if (const auto chosen = chosen_of(key, choices)) {
      auto& field = std::invoke(member, object_);
      field = static_cast<std::remove_cvref_t<decltype(field)>>(*chosen);
    }
  }

  /// Comes before the other keys of its table, which then change single parameters.
  void preset(const char* like, const char* source, const char*) {
    const auto model = chosen_of(like, kHeadModelNames);
    const auto from = chosen_of(source, kVeinSourceNames);
    if (model) {
      object_.params =
          vein_params(static_cast<HeadModel>(*model), from ? static_cast<VeinSource>(*from) : VeinSource::kAsPublished);
    } else if (from) {
      document_.refuse(*table_.get(source), where(source), "must come with \"like\"");
    }
  }

  template <class Member>
  void vector(const char* key, Member member, const Limits& limits, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      const toml::array* list = read_list(document_, *node, where(key), Count{3, 3});
      if (list == nullptr) {
        return;
      }
      Vec3 result;
      if (read_number(document_, *list->get(0), indexed(where(key), 0), limits, result.x) &&
          read_number(document_, *list->get(1), indexed(where(key), 1), limits, result.y) &&
          read_number(document_, *list->get(2), indexed(where(key), 2), limits, result.z)) {
        std::invoke(member, object_) = result;
      }
    }
  }

  template <class Member>
  void flag(const char* key, Member member, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      const auto* value = node->as_boolean();
      if (value == nullptr) {
        return document_.refuse(*node, where(key), "must be true or false");
      }
      std::invoke(member, object_) = value->get();
    }
  }

  template <class Member>
  void range(const char* key, Member member, const Limits& limits, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      const toml::array* pair = node->as_array();
      if (pair == nullptr || pair->size() != 2) {
        return document_.refuse(*node, where(key), "must be two numbers [lowest, highest]");
      }
      Range result = {};
      if (!read_number(document_, *pair->get(0), indexed(where(key), 0), limits, result[0]) ||
          !read_number(document_, *pair->get(1), indexed(where(key), 1), limits, result[1])) {
        return;
      }
      if (result[1] < result[0]) {
        return document_.refuse(*pair->get(1), indexed(where(key), 1),
                                "must be at least the lowest value " + to_text(result[0]));
      }
      std::invoke(member, object_) = result;
    }
  }

  template <class Member>
  void whole_range(const char* key, Member member, int min, int max, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      const toml::array* pair = node->as_array();
      const auto* low = pair == nullptr || pair->size() != 2 ? nullptr : pair->get(0)->as_integer();
      const auto* high = low == nullptr ? nullptr : pair->get(1)->as_integer();
      if (high == nullptr || low->get() < min || high->get() > max || high->get() < low->get()) {
        return document_.refuse(*node, where(key),
                                "must be two whole numbers [lowest, highest] in [" + std::to_string(min) + ", " +
                                    std::to_string(max) + "]");
      }
      std::invoke(member, object_) = {static_cast<int>(low->get()), static_cast<int>(high->get())};
    }
  }

  template <class Member>
  void numbers(const char* key, Member member, const Limits& limits, Count count, const char*,
               Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      const toml::array* list = read_list(document_, *node, where(key), count);
      if (list == nullptr) {
        return;
      }
      std::vector<double> result(list->size());
      for (std::size_t i = 0; i < result.size(); ++i) {
        if (!read_number(document_, *list->get(i), indexed(where(key), i), limits, result[i])) {
          return;
        }
      }
      std::invoke(member, object_) = std::move(result);
    }
  }

  template <class Member>
  void points(const char* key, Member member, const PointsRule& rule, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      read_points(document_, *node, where(key), rule, std::invoke(member, object_));
    }
  }

  template <class Member>
  void colour(const char* key, Member member, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      Colour result;
      if (read_colour(document_, *node, where(key), result)) {
        std::invoke(member, object_) = result;
      }
    }
  }

  template <class Member>
  void stops(const char* key, Member member, Count count, const char*, Need need) {
    const toml::node* node = find(key, need);
    if (node == nullptr) {
      return;
    }
    std::vector<ColourStop> result;
    if (node->is_string()) {
      ColourStop stop;
      if (!read_colour(document_, *node, where(key), stop.colour)) {
        return;
      }
      result.push_back(stop);
    } else if (const toml::array* list = read_list(document_, *node, where(key), count)) {
      for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string stop_path = indexed(where(key), i);
        const toml::array* pair = list->get(i)->as_array();
        if (pair == nullptr || pair->size() != 2) {
          return document_.refuse(*list->get(i), stop_path, "must be [position, \"#rrggbb\"]");
        }
        ColourStop stop;
        if (!read_number(document_, *pair->get(0), indexed(stop_path, 0), species_table::kUnit, stop.at) ||
            !read_colour(document_, *pair->get(1), indexed(stop_path, 1), stop.colour)) {
          return;
        }
        if (!result.empty() && stop.at < result.back().at) {
          return document_.refuse(*pair->get(0), indexed(stop_path, 0),
                                  "must be at least " + to_text(result.back().at) + " as the one before it");
        }
        result.push_back(stop);
      }
    } else {
      return;
    }
    std::invoke(member, object_) = std::move(result);
  }

  template <class Member>
  void sections(const char* one, const char* many, Member member, const char*) {
    const toml::node* single = find(one, Need::kOptional);
    const toml::node* several = find(many, Need::kOptional);
    if (single != nullptr && several != nullptr) {
      return document_.refuse(*several, where(many), "must be left out where " + std::string(one) + " is given");
    }
    std::vector<std::vector<SectionPoint>> result;
    if (single != nullptr) {
      document_.remember(where(many), single->source().begin);  // what check(Species) calls it
      if (!read_section(document_, *single, where(one), result.emplace_back())) {
        return;
      }
    } else if (several != nullptr) {
      const toml::array* list = read_list(document_, *several, where(many), species_table::kPoints);
      if (list == nullptr) {
        return;
      }
      for (std::size_t i = 0; i < list->size(); ++i) {
        if (!read_section(document_, *list->get(i), indexed(where(many), i), result.emplace_back())) {
          return;
        }
      }
    }
    std::invoke(member, object_) = std::move(result);
  }

  template <class Member>
  void table(const char* key, Member member, Layout, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      read_table(*node, where(key), std::invoke(member, object_));
    }
  }

  template <class Member>
  void option(const char* key, Member member, const char*) {
    if (const toml::node* node = find(key, Need::kOptional)) {
      read_table(*node, where(key), std::invoke(member, object_).emplace());
    }
  }

  template <class Member>
  void list(const char* key, Member member, Count count, const char*, Need need = Need::kOptional) {
    if (const toml::node* node = find(key, need)) {
      const toml::array* list = read_list(document_, *node, where(key), count);
      if (list == nullptr) {
        return;
      }
      auto& elements = std::invoke(member, object_);
      elements.clear();
      for (std::size_t i = 0; i < list->size() && !document_.failed(); ++i) {
        read_table(*list->get(i), indexed(where(key), i), elements.emplace_back());
      }
    }
  }

  template <class Member>
  void named(const char* key, Member member, Count count, const char*, Need need) {
    const toml::node* node = find(key, need);
    if (node == nullptr) {
      return;
    }
    const toml::table* tables = node->as_table();
    if (tables == nullptr) {
      return document_.refuse(*node, where(key), "must be a table of tables");
    }
    if (tables->size() < count.min || tables->size() > count.max) {
      return document_.fail(ErrorCode::kInvalidParameter, node->source().begin, where(key),
                            "must have " + std::to_string(count.min) + " to " + std::to_string(count.max) +
                                " entries, got " + std::to_string(tables->size()));
    }
    // toml++ sorts tables by key; the order of organs and pigments is that of the file.
    std::vector<std::pair<const toml::key*, const toml::node*>> entries;
    for (auto&& [name, value] : *tables) {
      entries.emplace_back(&name, &value);
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.first->source().begin < b.first->source().begin; });
    auto& elements = std::invoke(member, object_);
    elements.clear();
    for (const auto& [name, value] : entries) {
      if (!is_name(name->str())) {
        return document_.fail(ErrorCode::kInvalidParameter, name->source().begin,
                              where(key) + '.' + quoted(name->str()), kNameRule);
      }
      auto& element = elements.emplace_back();
      element.name = name->str();
      read_table(*value, where(key) + '.' + element.name, element);
      if (document_.failed()) {
        return;
      }
    }
  }

 private:
  std::string where(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + '.' + std::string(key);
  }

  /// The number of the choice that `key` names; none if it is absent or wrong.
  std::optional<std::size_t> chosen_of(const char* key, Choices choices) {
    const toml::node* node = find(key, Need::kOptional);
    if (node == nullptr) {
      return std::nullopt;
    }
    const auto* value = node->as_string();
    for (std::size_t i = 0; i < choices.size() && value != nullptr; ++i) {
      if (value->get() == choices[i]) {
        return i;
      }
    }
    std::string rule = "must be one of";
    for (std::size_t i = 0; i < choices.size(); ++i) {
      rule += (i == 0 ? " \"" : ", \"");
      rule += choices[i];
      rule += '"';
    }
    document_.refuse(*node, where(key), rule);
    return std::nullopt;
  }

  /// The value of `key`; null if it is absent (an error where it is needed) or an error was found before.
  const toml::node* find(const char* key, Need need) {
    if (document_.failed()) {
      return nullptr;
    }
    const toml::node* node = table_.get(key);
    if (node != nullptr) {
      document_.remember(where(key), node->source().begin);
    } else if (need == Need::kRequired) {
      document_.missing(table_.source().begin, where(key), "is missing");
    }
    return node;
  }

  template <class Part>
  void read_table(const toml::node& node, std::string path, Part& part) {
    const toml::table* table = node.as_table();
    if (table == nullptr) {
      return document_.refuse(node, path, "must be a table");
    }
    TableReader<Part>(document_, *table, std::move(path), part).run();
  }

  void refuse_unknown_keys() {
    KeyList known;
    describe(known, Table<T>{});
    const toml::key* first = nullptr;
    for (auto&& [key, value] : table_) {
      if (std::find(known.keys.begin(), known.keys.end(), key.str()) == known.keys.end() &&
          (first == nullptr || key.source().begin < first->source().begin)) {
        first = &key;
      }
    }
    if (first != nullptr) {
      const std::string_view near = nearest_name(first->str(), known.keys.data(), known.keys.size());
      document_.fail(ErrorCode::kUnknownParameter, first->source().begin, where(quotable(first->str())),
                     near.empty() ? "is not known" : "is not known; did you mean " + std::string(near) + "?");
    }
  }

  Document& document_;
  const toml::table& table_;
  std::string path_;
  T& object_;
};

/// Refuses what would send the parser or the destructors of its tables deep into recursion: brackets within brackets
/// and keys of many parts. toml++ 3.3 limits the first to 256 and does not limit the second. Refuses letters beyond
/// ASCII where TOML has no place for them as well, since looking at those its lexer runs past the end of a switch.
class FirstScan {
 public:
  FirstScan(std::string_view text, Document& document) : text_(text), document_(document) {}

  void run() {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") {  // a byte order mark is allowed
      at_ = 3;
    }
    while (at_ < text_.size() && !document_.failed()) {
      step();
    }
  }

 private:
  void step() {
    const char c = text_[at_];
    if (c == '"' || c == '\'') {
      return skip_string(c);
    }
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
      return;
    }
    if (static_cast<unsigned char>(c) >= 0x80) {
      return fail("is not TOML: characters beyond ASCII stand in quoted texts and comments only");
    }
    if (c == '[' || c == '{') {
      if (++depth_ > kMostNested) {
        fail("nests more than 32 values");
      }
      dots_ = 0;
    } else if (c == ']' || c == '}') {
      depth_ = std::max(depth_ - 1, 0);
      dots_ = 0;
    } else if (c == '.') {
      if (++dots_ >= kMostKeyParts) {
        fail("has a key of more than 16 parts");
      }
    } else if (c == ',' || c == '=') {
      dots_ = 0;
    } else if (c == '\n') {
      dots_ = 0;
      ++line_;
      line_start_ = at_ + 1;
    }
    ++at_;
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool long_string = text_.substr(at_, 3) == triple;
    at_ += long_string ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        if (!long_string) {
          return;  // an error, which the parser will word
        }
        ++line_;
        line_start_ = at_ + 1;
      } else if (c == '\\' && quote == '"') {
        ++at_;
        if (at_ < text_.size() && text_[at_] == '\n') {
          --at_;  // count the line
        }
      } else if (long_string ? text_.substr(at_, 3) == triple : c == quote) {
        at_ += long_string ? 3 : 1;
        return;
      }
    }
  }

  void fail(std::string message) {
    const auto column = static_cast<toml::source_index>(at_ - line_start_ + 1);
    document_.fail(ErrorCode::kParse, {line_, column}, "", std::move(message));
  }

  std::string_view text_;
  Document& document_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  toml::source_index line_ = 1;
  int depth_ = 0;
  int dots_ = 0;
};

/// toml++'s sentence, without its "Error while" and in one printable line.
std::string parse_message(std::string_view description) {
  constexpr std::string_view kStart = "Error while ";
  if (description.substr(0, kStart.size()) == kStart) {
    description.remove_prefix(kStart.size());
  }
  std::string message = "is not TOML: ";
  for (const char c : description.substr(0, 300)) {
    message += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return message;
}

template <class Named>
std::vector<std::string_view> names_of(const std::vector<Named>& elements) {
  std::vector<std::string_view> names;
  for (const Named& element : elements) {
    names.emplace_back(element.name);
  }
  return names;
}

void resolve_references(Document& document, const Species& species) {
  const std::vector<std::string_view> organs = names_of(species.organs);
  const std::vector<std::string_view> pigments = names_of(species.pigments);
  for (const Document::Reference& reference : document.references) {
    const bool organ = reference.of == NameOf::kOrgan;
    const std::vector<std::string_view>& names = organ ? organs : pigments;
    if (std::find(names.begin(), names.end(), reference.name) == names.end()) {
      const std::string_view near = nearest_name(reference.name, names.data(), names.size());
      document.fail(ErrorCode::kUnknownParameter, reference.position, reference.path,
                    std::string("must name one of the ") + (organ ? "organs" : "pigments") + ", got " +
                        quoted(reference.name) +
                        (near.empty() ? std::string() : "; did you mean \"" + std::string(near) + "\"?"));
    }
  }
}

bool exists(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0;
}

}  // namespace

Expected<Species> read_species(std::string_view text, std::string_view file_name) {
  if (text.size() > kSpeciesFileLimit) {
    return unexpected(
        Error{ErrorCode::kTooLarge, std::string(file_name) + ":",
              "must be at most " + std::to_string(kSpeciesFileLimit) + " bytes, got " + std::to_string(text.size())});
  }
  Document document(file_name);
  FirstScan(text, document).run();
  if (document.failed()) {
    return unexpected(document.take_error());
  }
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    document.fail(ErrorCode::kParse, parsed.error().source().begin, "", parse_message(parsed.error().description()));
    return unexpected(document.take_error());
  }

  Species species;
  TableReader<Species>(document, parsed.table(), "", species).run();
  if (!document.failed()) {
    resolve_references(document, species);
  }
  if (document.failed()) {
    return unexpected(document.take_error());
  }
  if (const std::optional<Error> error = check(species)) {
    return unexpected(document.with_place(*error));
  }
  species.sha256 = sha256(text);
  return species;
}

Expected<Species> load_species(const std::string& path) {
  return read_file(path, kSpeciesFileLimit).and_then([&](const std::string& text) { return read_species(text, path); });
}

Expected<Species> find_species(const std::string& name_or_path) {
  const std::span<const BuiltinSpecies> builtin = builtin_species();
  std::vector<std::string_view> names;
  for (const BuiltinSpecies& species : builtin) {
    if (species.name == name_or_path) {
      return read_species(species.text, name_or_path + ".toml");
    }
    names.push_back(species.name);
  }
  if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml") || exists(name_or_path)) {
    return load_species(name_or_path);
  }
  const std::string_view near = nearest_name(name_or_path, names.data(), names.size());
  return unexpected(Error{ErrorCode::kUnknownParameter, "",
                          "there is no species " + quoted(name_or_path) +
                              (near.empty() ? std::string("; `anthesis species` lists them")
                                            : "; did you mean " + std::string(near) + "?")});
}

}  // namespace anthesis
