#include "anthesis/exchange/species_key.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

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

/// As the supplement of O24 writes them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kSymbols = {
    {{"mu_sec", "sector_weight"},
     {"mu_age", "age_weight"},
     {"delta", "step_mm"},
     {"tau_m", "maturation_frames"},
     {"r_G", "ground_resistivity"},
     {"r_V", "mature_resistivity"},
     {"kappa", "reticulation.ratio_limit"},
     {"n", "murray_exponent"}}};

/// One key, on its way down into the tables.
struct Way {
  std::string_view whole;
  double value = 0.0;
  bool done = false;
  std::optional<Error> error = std::nullopt;

  void fail(ErrorCode code, std::string message) {
    if (!error && !done) {
      error = Error{code, std::string(whole), std::move(message)};
    }
  }
};

/// Sets the number that `path` names within one table; a visitor of species_table.h.
template <class T>
class NumberSetter {
 public:
  NumberSetter(T& object, std::string_view path, Way& way) : object_(object), way_(way) {
    const std::size_t dot = path.find('.');
    rest_ = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    name_ = path.substr(0, dot);
    if (const std::size_t bracket = name_.find('['); bracket != std::string_view::npos) {
      const std::string_view index = name_.substr(bracket + 1);
      std::size_t number = 0;
      const auto [end, code] = std::from_chars(index.data(), index.data() + index.size(), number);
      if (code == std::errc() && end + 1 == index.data() + index.size() && *end == ']') {
        index_ = number;
        name_ = name_.substr(0, bracket);
      }
    }
  }

  void run() {
    describe(*this, Table<T>{});
    if (!way_.done && !way_.error) {
      const std::string_view near = nearest_name(name_, keys_.data(), keys_.size());
      way_.fail(ErrorCode::kUnknownParameter,
                near.empty() ? "is not known" : "is not known; did you mean " + std::string(near) + "?");
    }
  }

  template <class Member>
  void number(const char* key, Member member, const Limits& limits, const char*, Need = Need::kOptional) {
    if (is(key) && allowed(limits)) {
      set(std::invoke(member, object_), way_.value);
    }
  }
  template <class Member>
  void integer(const char* key, Member member, int min, int max, const char*, Need = Need::kOptional) {
    if (is(key) && whole(min, max)) {
      set(std::invoke(member, object_), static_cast<int>(way_.value));
    }
  }
  template <class Member>
  void range(const char* key, Member member, const Limits& limits, const char*) {
    if (is(key) && allowed(limits)) {
      set(std::invoke(member, object_), Range{way_.value, way_.value});
    }
  }
  template <class Member>
  void whole_range(const char* key, Member member, int min, int max, const char*) {
    if (is(key) && whole(min, max)) {
      const int value = static_cast<int>(way_.value);
      set(std::invoke(member, object_), std::array<int, 2>{value, value});
    }
  }
  template <class Member>
  void points(const char* key, Member member, const PointsRule& rule, const char*, Need = Need::kOptional) {
    if (!rule.ascending) {
      return not_a_number(key);
    }
    if (is(key) && allowed(rule.y)) {
      set(std::invoke(member, object_), std::vector<Vec2>{{0.0, way_.value}, {1.0, way_.value}});
    }
  }
  template <class Member>
  void table(const char* key, Member member, Layout, const char*, Need = Need::kOptional) {
    if (leads_to(key)) {
      descend(std::invoke(member, object_));
    }
  }
  template <class Member>
  void option(const char* key, Member member, const char*) {
    if (leads_to(key)) {
      auto& part = std::invoke(member, object_);
      if (!part) {
        return way_.fail(ErrorCode::kInvalidParameter, "must be in a table that the species has, got none");
      }
      descend(*part);
    }
  }
  template <class Member>
  void list(const char* key, Member member, Count, const char*, Need = Need::kOptional) {
    if (leads_to(key)) {
      auto& elements = std::invoke(member, object_);
      if (!index_ || *index_ >= elements.size()) {
        return way_.fail(ErrorCode::kInvalidParameter,
                         "must be that of one of " + std::to_string(elements.size()) + " " + key + ": " + key + "[0]");
      }
      descend(elements[*index_]);
    }
  }
  template <class Member>
  void named(const char* key, Member member, Count, const char*, Need) {
    if (leads_to(key)) {
      auto& elements = std::invoke(member, object_);
      const std::string_view name = rest_.substr(0, rest_.find('.'));
      const auto found = std::find_if(elements.begin(), elements.end(), [&](const auto& e) { return e.name == name; });
      if (found == elements.end() || name.size() == rest_.size()) {
        return way_.fail(ErrorCode::kUnknownParameter, "must be a key of one of the species' " + std::string(key));
      }
      rest_.remove_prefix(name.size() + 1);
      descend(*found);
    }
  }
  // clang-format off
  template <class... R> void text(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void name(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void choice(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void vector(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void flag(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void numbers(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void colour(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void stops(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void sections(const char* one, const char* many, R&&...) { not_a_number(one), not_a_number(many); }
  template <class... R> void preset(const char* like, const char* source, R&&...) { not_a_number(like), not_a_number(source); }
  // clang-format on

 private:
  bool is(const char* key) {
    keys_.emplace_back(key);
    return name_ == key && rest_.empty() && !index_;
  }
  bool leads_to(const char* key) {
    keys_.emplace_back(key);
    return name_ == key && !rest_.empty() && !way_.error;
  }
  void not_a_number(const char* key) {
    if (name_ == key) {
      way_.fail(ErrorCode::kInvalidParameter, "must be a number, which this key is not");
    }
  }
  bool allowed(const Limits& limits) {
    if (limits.allow(way_.value)) {
      return true;
    }
    way_.fail(ErrorCode::kInvalidParameter, species_table::rule_text(limits) + ", got " + to_text(way_.value));
    return false;
  }
  bool whole(int min, int max) {
    if (way_.value == std::trunc(way_.value) && way_.value >= min && way_.value <= max) {
      return true;
    }
    way_.fail(ErrorCode::kInvalidParameter, "must be a whole number in [" + std::to_string(min) + ", " +
                                                std::to_string(max) + "], got " + to_text(way_.value));
    return false;
  }
  template <class Field, class Value>
  void set(Field& field, const Value& value) {
    field = value;
    way_.done = true;
  }
  template <class Part>
  void descend(Part& part) {
    NumberSetter<Part>(part, rest_, way_).run();
  }

  T& object_;
  Way& way_;
  std::string_view name_;  ///< first part of the path
  std::optional<std::size_t> index_;
  std::string_view rest_;
  std::vector<std::string_view> keys_;
};

}  // namespace

std::string whole_key(std::string_view key) {
  constexpr std::array<std::string_view, 5> kTables = {"head", "peduncle", "organs", "pigments", "vasculature"};
  const std::size_t first_end = key.find_first_of(".[");
  if (first_end != std::string_view::npos &&
      std::find(kTables.begin(), kTables.end(), key.substr(0, first_end)) != kTables.end()) {
    return std::string(key);
  }
  const auto symbol = std::find_if(kSymbols.begin(), kSymbols.end(), [&](const auto& s) { return s.first == key; });
  std::string whole = "vasculature.";
  whole += symbol == kSymbols.end() ? key : symbol->second;
  return whole;
}

std::optional<Error> set_number(Species& species, std::string_view key, double value) {
  const std::string whole = whole_key(key);
  Way way{whole, value};
  NumberSetter<Species>(species, whole, way).run();
  return way.error;
}

}  // namespace anthesis
