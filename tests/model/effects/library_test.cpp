// What every effect of the library must have, whoever adds one: the tests walk the library.
#include <set>

#include "model/effects/quantities.hpp"
#include "model/regression/candidates.hpp"
#include "model/regression/needs.hpp"
#include "model/regression/regressors.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// A model with a map of two components and a known rotation.
Model with_tables() {
  Model model;
  model.map = laser::ErrorMap{};
  for (const Component component : {Component::EXX, Component::EYX})
    for (const Approach a : {Approach::forward, Approach::reverse}) {
      const double reversal = a == Approach::forward ? 0.0 : 3.0;
      model.map->tables.push_back({component, a, {0.0, 400.0, 1100.0}, {reversal, 6.0, -4.0 + reversal}});
    }
  model.known.push_back({Component::ECX, {0.0, 500.0, 1100.0}, {1.0, 9.0, -3.0}});
  return model;
}

/// Readings along X in EX and EY with every column, all cells different.
Observations everything_varies() {
  laser::MeasurementSet set;
  for (const Sense sense : {Sense::EX, Sense::EY}) {
    measure(set, {.sense = sense, .step_mm = 70.0, .targets = 15, .parked_mm = {0.0, 200.0, 300.0}}, 1.0, nothing, 7);
  }
  std::mt19937_64 random(3);
  const auto uniform = [&](double least, double greatest) { return UniformDraws(least, greatest)(random); };
  for (Reading& r : set.readings) {
    r.position_mm[1] = uniform(100.0, 900.0);
    r.position_mm[2] = uniform(100.0, 900.0);
    r.feed_mm_min = uniform(100.0, 5000.0);
    r.load_kg = uniform(0.0, 500.0);
    r.extras["speed_mm_min"] = uniform(-5000.0, 5000.0);
    r.extras["reversed"] = static_cast<double>(r.row % 2);
    r.travel_since_reversal_mm = 60.0 * std::pow(uniform(0.0, 1.0), 3);  // some right behind it
    r.extras["time_since_reversal_s"] = uniform(0.0, 0.6);
    r.pressure_hPa = uniform(980.0, 1030.0);
    r.humidity_pct = uniform(30.0, 70.0);
    for (const char* sensor : {"t_material_degC", "t_air_degC", "t_column_degC"})
      r.sensors_degC[sensor] = uniform(18.0, 25.0);
  }
  return observations_of(set, with_tables(), mill());
}

/// Readings of a ball while the table C and the head B turn, the linear axes anywhere.
Observations ball_everywhere() {
  params::Machine machine = mill("TXYZ");
  machine.rotary_configuration = "TXYZCB";
  machine.rotary[1] = {{-90.0, 90.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 250.0}};
  machine.rotary[2] = {{0.0, 360.0}, {0.0, 0.0, 1.0}, {500.0, 400.0, 100.0}};
  std::mt19937_64 random(5);
  UniformDraws uniform(0.0, 1.0);
  laser::MeasurementSet set;
  for (int k = 0; k < 90; ++k) {
    Reading r{.row = k + 1,
              .axis = k % 2 == 0 ? Axis::Y : Axis::Z,
              .rotary = true,
              .position_mm = {900.0 * uniform(random), 900.0 * uniform(random), 900.0 * uniform(random)},
              .angle_deg = {0.0, 180.0 * uniform(random) - 90.0, 360.0 * uniform(random)},
              .sense = static_cast<Sense>(k % 3),
              .approach = k % 4 < 2 ? Approach::forward : Approach::reverse};
    r.extras["tool_z_mm"] = -100.0 * uniform(random);
    set.readings.push_back(r);
  }
  return observations_of(set, Model{}, machine);
}

/// Data that can show an effect: those of a ball for what only rotary axes have.
Observations data_for(const EffectDefinition& definition) {
  const bool of_ball = definition.place == Place::location || definition.place == Place::artefact ||
                       std::string_view(definition.id) == "tilt_scale";
  if (!of_ball) return everything_varies();
  Observations data = ball_everywhere();
  for (ThroughChain& one : data.through_chain) one.ball = 1;
  return data;
}

/// The first place at which a data set with everything shows the effect.
EffectInstance first_candidate(const Observations& data, const EffectDefinition& definition) {
  for (EffectInstance& one : candidate_instances(data))
    if (one.id == &definition) return one;
  return {};
}

/// Some value for every parameter, those of a wave and of a decay among the sizes of the data.
EffectInstance with_values(EffectInstance effect) {
  double value = 1.5;
  for (const ParameterDefinition& parameter : effect.definition().parameters) {
    if (parameter.coding == Coding::size_of_curve) continue;
    const bool searched = parameter.coding == Coding::searched;
    effect.parameters[std::string(parameter.name)] = searched ? 130.0 : parameter.coding == Coding::fixed ? 1.0 : value;
    value += 0.25;
  }
  return effect;
}

std::vector<double> prediction(const EffectInstance& effect, const Observations& data) {
  Model model = with_tables();
  model.effects = {effect};
  const auto values = predicted(model, data);
  REQUIRE_MESSAGE(values, to_text(effect));
  return *values;
}

/// Change of the contribution with a parameter, from the columns: d contribution / d coefficient times
/// d coefficient / d parameter.
Eigen::VectorXd slope_by_columns(const EffectInstance& effect, const std::string& parameter, double step,
                                 const Observations& data) {
  const std::string searched(effect.definition().searched_parameter());
  const double at = searched.empty() ? 0.0 : effect.parameters.at(searched);
  const Columns columns = Regressors(data).columns(effect, at);
  EffectInstance above = effect, below = effect;
  above.parameters[parameter] += step;
  below.parameters[parameter] -= step;
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.size()));
  for (std::size_t j = 0; j < effect.definition().column_count(); ++j) {
    const double change = held_coefficient(above, j).value() - held_coefficient(below, j).value();
    slope += columns.of.col(static_cast<Eigen::Index>(j)) * change / (2.0 * step);
  }
  return slope;
}

}  // namespace

TEST_CASE("every effect of the library says what it is, in words and units") {
  std::set<std::string_view> ids;
  for (const EffectDefinition& definition : effect_library()) {
    CAPTURE(definition.id);
    CHECK(ids.insert(definition.id).second);
    CHECK(effect_named(definition.id) == &definition);
    for (const std::string_view words :
         {definition.title, definition.formula, definition.cause, definition.tells_apart, definition.check,
          definition.headline, definition.how, definition.separated_by.sentence})
      CHECK(!words.empty());
    for (const ParameterDefinition& parameter : definition.parameters) {
      CAPTURE(parameter.name);
      CHECK(!parameter.meaning.empty());
      const bool pure_number = parameter.name == "factor" || parameter.name == "gain" || parameter.name == "fraction";
      CHECK(parameter.unit.empty() == pure_number);
      if (parameter.limits) CHECK(parameter.limits->least < parameter.limits->greatest);
    }
    for (const Becomes& other : definition.turns_into) CHECK(effect_named(other.effect) != nullptr);
  }
}

TEST_CASE("every effect has the one kind of contribution that its traits announce") {
  for (const EffectDefinition& definition : effect_library()) {
    CAPTURE(definition.id);
    const EffectTraits& traits = definition.traits;
    const bool user = definition.place == Place::formulas;
    CHECK((definition.fixed_part != nullptr) == traits.fixed_size);
    CHECK((definition.curve_factor != nullptr) == traits.is_curve);
    const bool columns = definition.columns != nullptr || definition.columns_of_place != nullptr;
    CHECK(columns == (!user && !traits.fixed_size && !traits.is_curve));
    CHECK(columns == (definition.column_count() > 0));
    CHECK((definition.search.tried != nullptr) == !definition.searched_parameter().empty());
    CHECK((definition.search.assumed != nullptr) == !definition.searched_parameter().empty());
    if (traits.periodic) CHECK(!definition.searched_parameter().empty());
    if (traits.keeps_mean || traits.keeps_slope) CHECK(traits.is_curve);
  }
}

TEST_CASE("data in which everything varies offer every effect a place, and lack nothing") {
  CHECK(untried_effects(everything_varies()).empty());
  for (const EffectDefinition& definition : effect_library()) {
    if (definition.place == Place::formulas) continue;
    CAPTURE(definition.id);
    const Observations data = data_for(definition);
    const EffectInstance effect = first_candidate(data, definition);
    CHECK(effect.id == &definition);
    if (effect.id != nullptr) CHECK(Regressors(data).acting(effect).rows.size() > 10);
  }
}

TEST_CASE("search, fit and name keep every size inside its physical range, whatever the readings ask for") {
  std::size_t ranges = 0;
  for (const EffectDefinition& definition : effect_library()) {
    for (const ParameterDefinition& parameter : definition.parameters)
      if (parameter.limits) CHECK_MESSAGE(definition.column_count() == 1, parameter.name);  // a search keeps one size
    const auto range = definition.column_count() == 1 ? definition.coefficient_range(0) : std::nullopt;
    if (!range) continue;
    ++ranges;
    CAPTURE(definition.id);
    Observations data = data_for(definition);
    const EffectInstance one = first_candidate(data, definition);
    const bool above = std::isfinite(range->greatest);
    const double beyond = above ? range->greatest + 0.7 * (range->greatest - range->least) : range->least - 1.0;
    const Eigen::VectorXd column = Regressors(data).columns(one, 0.0).of.col(0);
    std::mt19937_64 random(11);
    NormalDraws noise(0.0, 0.01 * column.cwiseAbs().maxCoeff());
    for (std::size_t k = 0; k < data.size(); ++k)
      data.reading[k] = beyond * column(static_cast<Eigen::Index>(k)) + noise(random);

    Model model;
    model.effects = {one};
    const auto fitted = must(fit(model, data));
    const ParameterEstimate& size = fitted.effects.front().parameters.front();
    if (definition.parameters.front().limits) {
      CHECK(size.value == definition.parameters.front().limits->greatest);
    } else {
      CHECK(size.value == 0.0);
    }
    CHECK_FALSE(size.sigma);
    CHECK_MESSAGE(contains(fitted.notes.front(), "is at the limit of its physical range"), fitted.notes.front());

    Model offset_alone;
    offset_alone.effects = {effect(effects::offset, Axis::X, Sense::EX)};
    for (const Model& base : {offset_alone, model}) {
      const auto found = must(diagnose(base, data, {.noise_replicates = 20}));
      CHECK(found.verdict != Verdict::adequate);
      for (const Candidate& candidate : found.candidates) CHECK_FALSE(same_candidate(candidate.effect, one));
    }
  }
  CHECK(ranges == 3);  // air_refraction, dead_path, cosine
}

TEST_CASE("a fit keeps every searched parameter inside the limits that these data give it") {
  for (const EffectDefinition& definition : effect_library()) {
    if (definition.search.limits == nullptr) continue;
    CAPTURE(definition.id);
    Observations data = data_for(definition);
    EffectInstance one = first_candidate(data, definition);
    const Acting acting = Regressors(data).acting(one);
    const std::string name(definition.searched_parameter());
    const TriedValues tried = tried_values(data, one, acting, {100});
    const double greatest = *std::max_element(tried.values.begin(), tried.values.end());
    EffectInstance true_one = with_values(one);
    true_one.parameters[name] = 5.0 * greatest;
    const std::vector<double> beyond = prediction(true_one, data);
    std::mt19937_64 random(13);
    NormalDraws noise(0.0, 0.02);
    for (std::size_t k = 0; k < data.size(); ++k) data.reading[k] = beyond[k] + noise(random);
    one.fitted[name] = 5.0 * greatest;
    Model model;
    model.effects = {one};
    CHECK(must(fit(model, data)).effects.front().effect.fitted.at(name) <= 1.001 * greatest);
  }
}

TEST_CASE("the contribution of every effect changes with its parameters as its columns say") {
  for (const EffectDefinition& definition : effect_library()) {
    if (definition.column_count() == 0) continue;
    CAPTURE(definition.id);
    const Observations data = data_for(definition);
    const EffectInstance effect = with_values(first_candidate(data, definition));
    for (const ParameterDefinition& parameter : definition.parameters) {
      if (parameter.coding == Coding::searched) continue;
      CAPTURE(parameter.name);
      constexpr double kStep = 1e-4;
      const std::string name(parameter.name);
      EffectInstance above = effect, below = effect;
      above.parameters[name] += kStep;
      below.parameters[name] -= kStep;
      const auto high = prediction(above, data), low = prediction(below, data);
      const Eigen::VectorXd slope = slope_by_columns(effect, name, kStep, data);
      CHECK(slope.norm() > 0.0);
      double worst = 0.0;
      for (std::size_t k = 0; k < data.size(); ++k)
        worst = std::max(worst, std::abs((high[k] - low[k]) / (2.0 * kStep) - slope(static_cast<Eigen::Index>(k))));
      CHECK(worst < 1e-6 * (1.0 + slope.cwiseAbs().maxCoeff()));
    }
  }
}

TEST_CASE("effects of fixed size and curves contribute what they hold") {
  const Observations data = everything_varies();
  for (const EffectDefinition& definition : effect_library()) {
    if (!definition.traits.fixed_size && !definition.traits.is_curve) continue;
    CAPTURE(definition.id);
    EffectInstance effect = with_values(first_candidate(data, definition));
    if (definition.traits.is_curve) effect.curve = {{0.0, 1200.0}, {2.0, 2.0}};
    const auto values = prediction(effect, data);
    const Acting acting = Regressors(data).acting(effect);
    double size = 0.0;
    for (const std::size_t k : acting.rows) {
      const ReadingAt at{data, k, effect, 130.0};
      const double expected =
          definition.traits.is_curve ? 2.0 * definition.curve_factor(at) : definition.fixed_part(at);
      CHECK(values[k] == Approx(expected));
      size += std::abs(expected);
    }
    CHECK(size > 0.0);
  }
}

TEST_CASE("every effect survives a model file") {
  for (const EffectDefinition& definition : effect_library()) {
    if (definition.place == Place::formulas) continue;
    CAPTURE(definition.id);
    const Observations data = data_for(definition);
    Model model;
    model.effects = {with_values(first_candidate(data, definition))};
    if (definition.traits.is_curve) model.effects.front().curve = {{0.0, 10.0}, {1.0, -1.0}};
    CHECK(must(parse_model(to_toml(model), "model.toml", {})).effects == model.effects);
  }
}

TEST_CASE("a model file holds two sensors, and a column of another kind is refused by its line") {
  const auto wrong =
      must_fail(parse_model("[[effect]]\nid = \"thermal_drift\"\naxis = \"X\"\nsensor = \"t_a_degC\"\n"
                            "sensor2 = \"time_s\"\n",
                            "model.toml", {}));
  CHECK(contains(wrong.message, "sensor2: expected a column"));
  EffectInstance drift = effect(effects::thermal_drift, Axis::X, Sense::EX);
  drift.sensor = "t_a_degC";
  drift.sensor2 = "t_b_degC";
  Model model;
  model.effects = {drift};
  CHECK(must(parse_model(to_toml(model), "model.toml", {})).effects == model.effects);
  CHECK(sensors_text(drift) == "t_a_degC and t_b_degC");
}

TEST_CASE("no time constant is tried below two intervals of the readings; a warming up of the model may be shorter") {
  constexpr double kInterval_s = 10.0;  // of the readings of `measured`
  for (const EffectId id : {effects::warm_up, effects::thermal_drift})
    for (const int targets : {6, 200})
      for (const bool is_of_model : {false, true}) {
        EffectInstance one{.id = id, .axis = Axis::X, .sense = Sense::EX};  // its lag is searched too
        if (id == effects::thermal_drift) one.sensor = "t_material_degC";
        const Observations data =
            observations_of(measured({.targets = targets, .runs = 1}, 0.3, nothing), Model{}, mill());
        const TriedValues tried = tried_values(data, one, Regressors(data).acting(one), {100, is_of_model});
        REQUIRE(tried.values.size() > 1);
        const double measured_s = kInterval_s * (2.0 * targets - 1.0), least_s = measured_s / 50.0;
        const bool may_be_shorter = is_of_model && id == effects::warm_up;
        CHECK(tried.values.front() == doctest::Approx(may_be_shorter ? least_s : std::max(2.0 * kInterval_s, least_s)));
        CHECK(tried.values.back() == doctest::Approx(measured_s));
      }
}
