// The emulator's list of effects, walked: what every definition owes to hidden cases and errors files.
#include <set>

#include <fmt/format.h>

#include "ecs_emulator/effects/definition.hpp"
#include "modules/hidden_cases/tests/hidden_cases.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Everything at a value that no formula takes for zero.
class PlainConditions final : public Conditions {
 public:
  explicit PlainConditions(double at_mm) {
    p_mm = at_mm;
    curve = 2.0;
    time_s = 1800.0;
    feed_mm_min = 3000.0;
    load_kg = 250.0;
    travel_since_reversal_mm = 12.0;
  }
  [[nodiscard]] double material_degC() const override { return 23.0; }
  [[nodiscard]] double degC(const std::string& sensor) const override { return sensor == "second" ? 21.0 : 26.0; }
  [[nodiscard]] double first_degC(const std::string&) const override { return 20.5; }
  [[nodiscard]] double missing_refraction() const override { return 1.5e-6; }
  [[nodiscard]] double known_value() const override { return 12.0; }
};

PlacedEffect with_parameters(const EffectDefinition& kind) {
  PlacedEffect effect{.kind = &kind, .sensor = "first", .sensor2 = "second"};
  double value = 2.0;
  for (const ParameterDefinition& parameter : kind.parameters) effect.parameters[std::string(parameter.name)] = value++;
  return effect;
}

/// The table of an errors file that says the same.
std::string table_of(const PlacedEffect& effect) {
  const EffectDefinition& kind = *effect.kind;
  std::string text = fmt::format("[[effect]]\nid = \"{}\"\n", kind.id);
  if (kind.placed_by == PlacedBy::code_of_rotation)
    text += "code = \"ECX\"\n";
  else if (kind.placed_by == PlacedBy::code_of_squareness)
    text += "code = \"B0Z\"\n";
  else if (kind.placed_by == PlacedBy::code_of_set_up)
    text += "code = \"EC\"\n";
  else
    text += "axis = \"X\"\nsense = \"EY\"\n";
  if (kind.sensors > 0) text += "sensor = \"first\"\n";
  if (kind.sensors > 1) text += "sensor2 = \"t_second_degC\"\n";
  if (kind.curve != CurveOf::nothing) return text + "formula = \"2\"\n";
  text += "[effect.parameters]\n";
  for (const auto& [name, value] : effect.parameters) text += fmt::format("{} = {}\n", name, value);
  return text;
}

Component component_in_table(const EffectDefinition& kind) {
  if (kind.placed_by == PlacedBy::code_of_rotation) return Component::ECX;
  return kind.placed_by == PlacedBy::code_of_squareness ? Component::B0Z : Component::EYX;
}

}  // namespace

TEST_CASE("every effect has an id of its own and is found by it") {
  std::set<std::string_view> ids;
  for (const EffectDefinition* kind : effects()) {
    CAPTURE(kind->id);
    CHECK(ids.insert(kind->id).second);
    CHECK(effect_named(kind->id) == kind);
  }
  CHECK(effect_named("no_such_effect") == nullptr);
}

TEST_CASE("every effect has parameters with units, or a curve, or is a fault of the map as it is") {
  for (const EffectDefinition* kind : effects()) {
    CAPTURE(kind->id);
    const bool curve = kind->curve != CurveOf::nothing;
    CHECK((curve != !kind->parameters.empty() || kind->fixed_size));
    bool optional = false;
    for (const ParameterDefinition& parameter : kind->parameters) {
      CAPTURE(parameter.name);
      CHECK(!parameter.name.empty());
      CHECK(!parameter.unit.empty());
      CHECK(parameter.range.above < parameter.range.below);
      CHECK((!optional || parameter.optional));  // those that an errors file must give come first
      optional = parameter.optional;
    }
  }
}

TEST_CASE("every effect says what it adds, where it can be and how it is drawn") {
  for (const EffectDefinition* kind : effects()) {
    CAPTURE(kind->id);
    CHECK((kind->value != nullptr) != (kind->seat == Seat::unit));
    CHECK((kind->spoil != nullptr) == (kind->seat == Seat::unit));
    REQUIRE((kind->places != nullptr));
    if (kind->draw == nullptr) CHECK(kind->parameters.size() <= 1);
    if (!kind->line.empty()) CHECK(effect_named(kind->line) != nullptr);
  }
}

TEST_CASE("every contribution is finite and grows with its parameters as they say") {
  for (const EffectDefinition* kind : effects()) {
    if (kind->value == nullptr) continue;
    CAPTURE(kind->id);
    const PlacedEffect effect = with_parameters(*kind);
    for (const double p_mm : {-700.0, 0.0, 300.0, 1250.0}) {
      const double value = kind->value(effect, PlainConditions(p_mm));
      CHECK(std::isfinite(value));
      if (kind->curve == CurveOf::nothing)
        CHECK(kind->value(scaled(effect, 3.0), PlainConditions(p_mm)) == Approx(3.0 * value));
    }
    CHECK(kind->value(effect, PlainConditions(1250.0)) != 0.0);
  }
}

TEST_CASE("every effect of the machine reads from an errors file what its definition computes") {
  MachineState state{.position_mm = {300.0, 0.0, 0.0}, .feed_mm_min = 3000.0, .load_kg = 250.0, .time_s = 1800.0};
  state.travel_since_reversal_mm[0] = 12.0;
  class StateOfFile final : public Conditions {
   public:
    [[nodiscard]] double material_degC() const override { return 20.0; }
    [[nodiscard]] double degC(const std::string& sensor) const override { return sensor == "first" ? 26.0 : 21.0; }
    [[nodiscard]] double first_degC(const std::string&) const override { return 20.0; }
  } expected;
  expected.p_mm = 300.0;
  expected.curve = 2.0;
  expected.time_s = 1800.0;
  expected.feed_mm_min = 3000.0;
  expected.load_kg = 250.0;
  expected.travel_since_reversal_mm = 12.0;
  for (const EffectDefinition* kind : effects()) {
    CAPTURE(kind->id);
    const PlacedEffect effect = with_parameters(*kind);
    const std::string text = table_of(effect) + "[temperature]\nfirst = '20 + t/300'\nsecond = '21'\n";
    const auto errors = TrueErrors::parse(text, "errors.toml", ".");
    CHECK(errors.has_value() == kind->elsewhere.empty());
    if (!errors) {
      CHECK(contains(to_text(errors.error()), kind->elsewhere));
      continue;
    }
    CHECK(errors->at(state)[index_of(component_in_table(*kind))] == Approx(kind->value(effect, expected)));
  }
}

TEST_CASE("what spans an effect spans what is drawn of it") {
  for (const EffectDefinition* kind : drawn_effects()) {
    CAPTURE(kind->id);
    const HiddenCase c = case_of(request_for(21, CaseKind::single, kind->id));
    const Ground ground = ground_of(c.scene);
    CHECK(!unit_effects(ground, c.hidden.at(0).effect).empty());
    for (const PlacedEffect& unit : unit_effects(ground, c.hidden[0].effect))
      for (const double value : contribution(c.scene, unit)) REQUIRE(std::isfinite(value));
  }
}
