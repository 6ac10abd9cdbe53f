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

constexpr std::string_view kUnknown = "is not known";

/// As the supplement of O24 writes them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kSymbols = {
    {{"mu_sec", "sector_weight"},
     {"mu_age", "age_weight"},
     {"delta", "step_mm"},
     {"delta_step", "step_mm"},
     {"tau_m", "maturation_frames"},
     {"tau_d", "reticulation.delay_frames"},
     {"r_G", "ground_resistivity"},
     {"r_V", "mature_resistivity"},
     {"kappa", "reticulation.ratio_limit"},
     {"n", "murray_exponent"}}};

/// Symbols that stand for a number of every strand, where a species has one for each kind.
constexpr std::array<std::string_view, 7> kJitters = {
    "bract.jitter",  "bract.strand_jitter",  "trans_floret.jitter", "trans_floret.strand_jitter",
    "floret.jitter", "floret.strand_jitter", "colonisation.jitter"};
constexpr std::array<std::string_view, 3> kTips = {"floret_tip_mm", "abaxial_tip_mm", "adaxial_tip_mm"};
constexpr std::array<std::string_view, 3> kJointSymbols = {"eta", "gamma_max", "rho"};

/// The keys that a key or a symbol stands for.
std::vector<std::string> whole_keys(std::string_view key) {
  std::vector<std::string> keys;
  const std::string table = "vasculature.";
  if (key == "eta" || key == "gamma_max") {
    for (const std::string_view jitter : kJitters) {
      keys.push_back(table + std::string(jitter) + (key == "eta" ? ".probability" : ".strength"));
    }
  } else if (key == "rho") {
    for (const std::string_view tip : kTips) {
      keys.push_back(table + std::string(tip));
    }
  } else {
    keys.push_back(whole_key(key));
  }
  return keys;
}

/// The symbol that was meant by a key of no table, if any is like it.
std::string_view nearest_symbol(std::string_view key) {
  std::vector<std::string_view> symbols(kJointSymbols.begin(), kJointSymbols.end());
  for (const auto& [symbol, name] : kSymbols) {
    symbols.push_back(symbol);
  }
  return nearest_name(key, symbols.data(), symbols.size());
}

/// One key, on its way down into the tables.
struct Way {
  std::string_view whole;
  double value = 0.0;  ///< the number, or what it is multiplied by
  bool factor = false;
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
    const std::string_view part = path.substr(0, dot);
    name_ = part.substr(0, part.find('['));
    for (std::string_view rest = part.substr(name_.size()); !rest.empty();) {  // [2][0]
      std::size_t index = 0;
      const auto [end, code] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), index);
      if (rest[0] != '[' || code != std::errc() || end == rest.data() + rest.size() || *end != ']') {
        name_ = part;  // which is no key
        indices_.clear();
        return;
      }
      indices_.push_back(index);
      rest.remove_prefix(static_cast<std::size_t>(end + 1 - rest.data()));
    }
  }

  void run() {
    describe(*this, Table<T>{});
    if (!way_.done && !way_.error) {
      const std::string_view near = nearest_name(name_, keys_.data(), keys_.size());
      std::string message(kUnknown);
      if (!near.empty()) {
        message.append("; did you mean ").append(near).append("?");
      }
      way_.fail(ErrorCode::kUnknownParameter, std::move(message));
    }
  }

  template <class Member>
  void number(const char* key, Member member, const Limits& limits, const char*, Need = Need::kOptional) {
    if (is(key)) {
      change(std::invoke(member, object_), limits);
    }
  }
  template <class Member>
  void integer(const char* key, Member member, int min, int max, const char*, Need = Need::kOptional) {
    if (is(key)) {
      auto& number = std::invoke(member, object_);
      const double wanted = changed(static_cast<double>(number));
      if (whole(wanted, min, max)) {
        number = static_cast<int>(wanted);
        way_.done = true;
      }
    }
  }
  template <class Member>
  void range(const char* key, Member member, const Limits& limits, const char*) {
    auto& range = std::invoke(member, object_);
    if (is(key)) {
      change_all({&range[0], &range[1]}, limits);
    } else if (name_ == key && rest_.empty() && indices_.size() == 1 && indices_[0] < 2) {
      change(range[indices_[0]], limits);
    }
  }
  template <class Member>
  void whole_range(const char* key, Member member, int min, int max, const char*) {
    if (is(key)) {
      auto& range = std::invoke(member, object_);
      const double from = changed(range[0]);
      const double to = changed(range[1]);
      if (whole(from, min, max) && whole(to, min, max)) {
        range = {static_cast<int>(from), static_cast<int>(to)};
        way_.done = true;
      }
    }
  }
  template <class Member>
  void numbers(const char* key, Member member, const Limits& limits, Count, const char*, Need = Need::kOptional) {
    if (is_list(key, 1)) {
      auto& list = std::invoke(member, object_);
      if (!indices_.empty()) {
        if (double* number = element(key, list, indices_[0])) {
          change(*number, limits);
        }
      } else {
        std::vector<double*> all;
        for (double& number : list) {
          all.push_back(&number);
        }
        change_all(all, limits);
      }
    }
  }
  template <class Member>
  void points(const char* key, Member member, const PointsRule& rule, const char*, Need = Need::kOptional) {
    if (rule.ascending && is(key) && !way_.factor) {
      if (allowed(way_.value, rule.y)) {
        std::invoke(member, object_) = std::vector<Vec2>{{0.0, way_.value}, {1.0, way_.value}};
        way_.done = true;
      }
    } else if (is_list(key, 2)) {
      auto& list = std::invoke(member, object_);
      if (!indices_.empty()) {
        if (Vec2* point = element(key, list, indices_[0]); point != nullptr && coordinate(key, 2)) {
          indices_[1] == 0 ? change(point->x, rule.x) : change(point->y, rule.y);
        }
      } else {
        std::vector<double*> xs;
        std::vector<double*> ys;
        for (Vec2& point : list) {
          xs.push_back(&point.x);
          ys.push_back(&point.y);
        }
        if (rule.ascending) {  // a function keeps its times, a curve grows as a whole
          change_all(ys, rule.y);
        } else if (all_allowed(ys, rule.y)) {
          if (change_all(xs, rule.x)) {
            change_all(ys, rule.y);
          }
        }
      }
    }
  }
  template <class Member>
  void vector(const char* key, Member member, const Limits& limits, const char*) {
    if (is_list(key, 1)) {
      Vec3& vector = std::invoke(member, object_);
      const std::array<double*, 3> parts = {&vector.x, &vector.y, &vector.z};
      if (indices_.empty()) {
        change_all({parts.begin(), parts.end()}, limits);
      } else if (indices_[0] < parts.size()) {
        change(*parts[indices_[0]], limits);
      } else {
        way_.fail(ErrorCode::kInvalidParameter, "must end in [0], [1] or [2]");
      }
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
      if (auto* found = element(key, elements, indices_.size() == 1 ? indices_[0] : elements.size())) {
        descend(*found);
      }
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
  template <class... R> void flag(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void colour(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void stops(const char* key, R&&...) { not_a_number(key); }
  template <class... R> void sections(const char* one, const char* many, R&&...) { not_a_number(one), not_a_number(many); }
  template <class... R> void preset(const char* like, const char* source, R&&...) { not_a_number(like), not_a_number(source); }
  // clang-format on

 private:
  /// Whether the key itself is meant.
  bool is(const char* key) {
    keys_.emplace_back(key);
    return name_ == key && rest_.empty() && indices_.empty();
  }
  /// Whether a number in its list of so many dimensions is meant, or all of them and a factor.
  bool is_list(const char* key, std::size_t dimensions) {
    keys_.emplace_back(key);
    if (name_ != key || !rest_.empty() || way_.done || way_.error) {
      return false;
    }
    if (indices_.size() == dimensions || (indices_.empty() && way_.factor)) {
      return true;
    }
    std::string example = key;
    for (std::size_t i = 0; i < dimensions; ++i) {
      example += "[0]";
    }
    way_.fail(ErrorCode::kInvalidParameter, "must be a number, which this key is not; " + example + " is one");
    return false;
  }
  bool leads_to(const char* key) {
    keys_.emplace_back(key);
    if (rest_.empty()) {
      not_a_number(key);
    }
    return name_ == key && !rest_.empty() && !way_.error;
  }
  void not_a_number(const char* key) {
    if (name_ == key) {
      way_.fail(ErrorCode::kInvalidParameter, "must be a number, which this key is not");
    }
  }
  template <class Element>
  Element* element(const char* key, std::vector<Element>& elements, std::size_t index) {
    if (index < elements.size()) {
      return &elements[index];
    }
    way_.fail(ErrorCode::kInvalidParameter,
              "must be that of one of " + std::to_string(elements.size()) + " " + key + ": " + key + "[0]");
    return nullptr;
  }
  bool coordinate(const char* key, std::size_t count) {
    if (indices_[1] < count) {
      return true;
    }
    way_.fail(ErrorCode::kInvalidParameter,
              "must end in [0] or [1]: " + std::string(key) + "[" + std::to_string(indices_[0]) + "][0]");
    return false;
  }
  double changed(double number) const { return way_.factor ? number * way_.value : way_.value; }
  bool allowed(double value, const Limits& limits) {
    if (limits.allow(value)) {
      return true;
    }
    way_.fail(ErrorCode::kInvalidParameter, species_table::rule_text(limits) + ", got " + to_text(value));
    return false;
  }
  bool whole(double value, int min, int max) {
    if (value == std::trunc(value) && value >= min && value <= max) {
      return true;
    }
    way_.fail(ErrorCode::kInvalidParameter, "must be a whole number in [" + std::to_string(min) + ", " +
                                                std::to_string(max) + "], got " + to_text(value));
    return false;
  }
  void change(double& number, const Limits& limits) { change_all({&number}, limits); }
  bool all_allowed(const std::vector<double*>& numbers, const Limits& limits) {
    return std::all_of(numbers.begin(), numbers.end(), [&](double* n) { return allowed(changed(*n), limits); });
  }
  /// All or none.
  bool change_all(const std::vector<double*>& numbers, const Limits& limits) {
    if (!all_allowed(numbers, limits)) {
      return false;
    }
    for (double* number : numbers) {
      *number = changed(*number);
    }
    way_.done = true;
    return true;
  }
  template <class Part>
  void descend(Part& part) {
    NumberSetter<Part>(part, rest_, way_).run();
  }

  T& object_;
  Way& way_;
  std::string_view name_;  ///< first part of the path
  std::vector<std::size_t> indices_;
  std::string_view rest_;
  std::vector<std::string_view> keys_;
};

std::optional<Error> change_number(Species& species, std::string_view key, double value, bool factor) {
  const std::vector<std::string> keys = whole_keys(key);
  Species changed;
  if (keys.size() > 1) {  // all or none
    changed = species;
  }
  for (const std::string& whole : keys) {
    Way way{whole, value, factor};
    NumberSetter<Species>(keys.size() > 1 ? changed : species, whole, way).run();
    if (way.error) {
      const std::string_view symbol = nearest_symbol(key);
      if (way.error->message == kUnknown && !symbol.empty()) {
        way.error->message.append("; did you mean ").append(symbol).append("?");
      }
      return way.error;
    }
  }
  if (keys.size() > 1) {
    species = std::move(changed);
  }
  return std::nullopt;
}

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
  return change_number(species, key, value, false);
}

std::optional<Error> scale_number(Species& species, std::string_view key, double factor) {
  return change_number(species, key, factor, true);
}

}  // namespace anthesis
