#include <functional>
#include <nlohmann/json.hpp>
#include <string>

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

using Json = nlohmann::ordered_json;

constexpr const char* kNamePattern = "^[A-Za-z0-9_-]{1,64}$";
constexpr const char* kColourPattern = "^#[0-9A-Fa-f]{6}$";

Json schema_number(const Limits& limits) {
  return {{"type", "number"},
          {limits.open_min ? "exclusiveMinimum" : "minimum", limits.min},
          {limits.open_max ? "exclusiveMaximum" : "maximum", limits.max}};
}

Json schema_list(Json items, Count count) {
  return {{"type", "array"}, {"minItems", count.min}, {"maxItems", count.max}, {"items", std::move(items)}};
}

Json schema_pair(Json first, Json second) {
  return {{"type", "array"},
          {"minItems", 2},
          {"maxItems", 2},
          {"items", Json::array({std::move(first), std::move(second)})}};
}

Json schema_colour() {
  return {{"type", "string"}, {"pattern", kColourPattern}};
}

template <class T>
Json schema_of();

/// Describes one table; a visitor of species_table.h.
template <class T>
class SchemaWriter {
 public:
  Json properties = Json::object();
  Json required = Json::array();

  template <class Member>
  void text(const char* key, Member, const char* meaning, Need need = Need::kOptional) {
    put(key, {{"type", "string"}, {"maxLength", species_table::kLongestText}}, meaning, need);
  }
  template <class Member>
  void name(const char* key, Member, NameOf, const char* meaning, Need need = Need::kOptional) {
    put(key, {{"type", "string"}, {"pattern", kNamePattern}}, meaning, need);
  }
  template <class Member>
  void number(const char* key, Member member, const Limits& limits, const char* meaning, Need need = Need::kOptional) {
    put(key, schema_number(limits), meaning, need, member);
  }
  template <class Member>
  void integer(const char* key, Member member, int min, int max, const char* meaning, Need need = Need::kOptional) {
    put(key, {{"type", "integer"}, {"minimum", min}, {"maximum", max}}, meaning, need, member);
  }
  template <class Member>
  void choice(const char* key, Member member, Choices choices, const char* meaning) {
    Json schema = {{"type", "string"}, {"enum", choices}};
    schema["default"] = choices[static_cast<std::size_t>(std::invoke(member, default_))];
    put(key, std::move(schema), meaning, Need::kOptional);
  }
  template <class Member>
  void vector(const char* key, Member member, const Limits& limits, const char* meaning) {
    Json schema = schema_list(schema_number(limits), Count{3, 3});
    const Vec3 value = std::invoke(member, default_);
    schema["default"] = {value.x, value.y, value.z};
    put(key, std::move(schema), meaning, Need::kOptional);
  }
  template <class Member>
  void flag(const char* key, Member member, const char* meaning) {
    put(key, {{"type", "boolean"}}, meaning, Need::kOptional, member);
  }
  template <class Member>
  void range(const char* key, Member member, const Limits& limits, const char* meaning) {
    put(key, schema_pair(schema_number(limits), schema_number(limits)), meaning, Need::kOptional, member);
  }
  template <class Member>
  void whole_range(const char* key, Member member, int min, int max, const char* meaning) {
    const Json number = {{"type", "integer"}, {"minimum", min}, {"maximum", max}};
    put(key, schema_pair(number, number), meaning, Need::kOptional, member);
  }
  void preset(const char* like, const char* source, const std::string& meaning) {
    put(like, {{"type", "string"}, {"enum", kHeadModelNames}}, meaning, Need::kOptional);
    put(source, {{"type", "string"}, {"enum", kVeinSourceNames}, {"default", "as_published"}}, meaning,
        Need::kOptional);
  }
  template <class Member>
  void numbers(const char* key, Member, const Limits& limits, Count count, const char* meaning,
               Need need = Need::kOptional) {
    put(key, schema_list(schema_number(limits), count), meaning, need);
  }
  template <class Member>
  void points(const char* key, Member, const PointsRule& rule, const char* meaning, Need need = Need::kOptional) {
    put(key, schema_list(schema_pair(schema_number(rule.x), schema_number(rule.y)), rule.count), meaning, need);
  }
  template <class Member>
  void colour(const char* key, Member, const char* meaning) {
    put(key, schema_colour(), meaning, Need::kOptional);
  }
  template <class Member>
  void stops(const char* key, Member, Count count, const char* meaning, Need need) {
    const Json list = schema_list(schema_pair(schema_number(species_table::kUnit), schema_colour()), count);
    put(key, {{"oneOf", Json::array({schema_colour(), list})}}, meaning, need);
  }
  template <class Member>
  void sections(const char* one, const char* many, Member, const char* meaning) {
    const Json point = {{"type", "array"}, {"minItems", 2}, {"maxItems", 3}, {"items", {{"type", "number"}}}};
    const Json section = schema_list(point, species_table::kSectionPoints);
    put(one, section, std::string(meaning) + " One for all rows.", Need::kOptional);
    put(many, schema_list(section, species_table::kPoints), std::string(meaning) + " One for each row.",
        Need::kOptional);
  }
  template <class Member>
  void table(const char* key, Member member, Layout, const char* meaning, Need need = Need::kOptional) {
    using Part = std::remove_cvref_t<decltype(std::invoke(member, default_))>;
    put(key, schema_of<Part>(), meaning, need);
  }
  template <class Member>
  void option(const char* key, Member member, const char* meaning) {
    using Part = typename std::remove_cvref_t<decltype(std::invoke(member, default_))>::value_type;
    put(key, schema_of<Part>(), meaning, Need::kOptional);
  }
  template <class Member>
  void list(const char* key, Member member, Count count, const char* meaning, Need need = Need::kOptional) {
    using Part = typename std::remove_cvref_t<decltype(std::invoke(member, default_))>::value_type;
    put(key, schema_list(schema_of<Part>(), count), meaning, need);
  }
  template <class Member>
  void named(const char* key, Member member, Count count, const char* meaning, Need need) {
    using Part = typename std::remove_cvref_t<decltype(std::invoke(member, default_))>::value_type;
    put(key,
        {{"type", "object"},
         {"minProperties", count.min},
         {"maxProperties", count.max},
         {"propertyNames", {{"pattern", kNamePattern}}},
         {"additionalProperties", schema_of<Part>()}},
        meaning, need);
  }

 private:
  void put(const char* key, Json schema, const std::string& meaning, Need need) {
    Json property = {{"description", meaning}};
    property.update(schema);
    properties[key] = std::move(property);
    if (need == Need::kRequired) {
      required.push_back(key);
    }
  }
  template <class Member>
  void put(const char* key, Json schema, const std::string& meaning, Need need, Member member) {
    if (need == Need::kOptional) {
      schema["default"] = std::invoke(member, default_);
    }
    put(key, std::move(schema), meaning, need);
  }

  const T default_ = {};
};

template <class T>
Json schema_of() {
  SchemaWriter<T> writer;
  describe(writer, Table<T>{});
  Json schema = {{"type", "object"}, {"additionalProperties", false}};
  if (!writer.required.empty()) {
    schema["required"] = std::move(writer.required);
  }
  schema["properties"] = std::move(writer.properties);
  return schema;
}

}  // namespace

std::string species_schema() {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "Anthesis species file"},
                 {"description", "A flowering plant that anthesis can grow."}};
  schema.update(schema_of<Species>());
  return schema.dump(2) + '\n';
}

}  // namespace anthesis
