// Sequential discrimination between rival models (Hunter and Reiner 1965; Box and Hill 1967): after each run the one
// that separates best per minute among those still possible.
#include "modules/investigation/investigation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "model/diagnosis/ladder.hpp"
#include "model/effects/definition.hpp"
#include "model/planning/run.hpp"

namespace ecs::commissioning {
namespace {

using model::Candidate;
using model::Diagnosis;
using model::MeasurementProposal;
using model::Model;
using model::Verdict;

/// Runs in all: a bound, not a plan.
constexpr std::size_t kMostRuns = 30;
/// Without a proof, what follows a temperature or the clock is added from this probability on.
constexpr double kProbable = 0.95;
/// Of the minutes, kept from looks at lines cold and warm for runs that separate.
constexpr double kShareToSeparate = 0.15;

tl::unexpected<Problem> stopped() { return problem(ProblemKind::refused, "the investigation was stopped"); }

/// What makes a run the same as one that was made: asked again it would tell the same.
using RunKey = std::tuple<std::string, Axis, Sense>;
RunKey key_of(const MeasurementProposal& proposal) { return {proposal.condition, proposal.axis, proposal.sense}; }

std::string short_text(const MeasurementProposal& proposal) {
  if (proposal.ball)
    return fmt::format("ball {}: {} readings a run, {} {} both ways", proposal.condition,
                       proposal.ball->readings.size(), proposal.runs, proposal.runs == 1 ? "run" : "runs");
  return fmt::format("{} along {}, {}: {} targets, {} {}{}", name_of(proposal.sense), letter_of(proposal.axis),
                     proposal.condition, proposal.targets_mm.size(), proposal.runs, proposal.runs == 1 ? "run" : "runs",
                     proposal.bidirectional ? " both ways" : "");
}

/// The same with as many runs as the readings have: a person may have measured fewer than were asked for.
MeasurementProposal as_measured(MeasurementProposal proposal, const laser::MeasurementSet& set) {
  std::set<int> runs;
  for (const laser::Reading& reading : set.readings) runs.insert(reading.run);
  proposal.runs = std::min(proposal.runs, static_cast<int>(runs.size()));
  return proposal;
}

/// The effect where the diagnosis found it: its period or place is held, its sizes are fitted.
model::EffectInstance at_its_value(model::EffectInstance effect) {
  const std::string searched(effect.definition().searched_parameter());
  if (const auto value = effect.fitted.find(searched); value != effect.fitted.end())
    effect.parameters[searched] = value->second;
  return effect;
}

/// The opposite for the model that is written: the user's own fits may move the period or place with the other sizes.
/// The lag behind a sensor stays: a fit keeps it above a fiftieth of the whole time, which is longer now.
void free_again(Model& model, const model::EffectInstance& found) {
  if (found.traits().has_lag) return;
  const std::string searched(found.definition().searched_parameter());
  for (model::EffectInstance& effect : model.effects)
    if (model::same_candidate(effect, found) && effect.fitted.contains(searched)) effect.parameters.erase(searched);
}

/// The period is a pitch of the axis, or that of two starts or half a turn.
bool is_pitch(double period_mm, const params::MachineAxis& facts) {
  constexpr double kSame = 0.01;  // of the pitch: as well as a first look can tell
  for (const auto& pitch_mm : {facts.screw_pitch_mm, facts.scale_pitch_mm})
    for (const double turns : {0.5, 1.0, 2.0})
      if (pitch_mm && std::abs(period_mm - turns * *pitch_mm) < kSame * turns * *pitch_mm) return true;
  return false;
}

/// What bends a machine that was switched on cold shows as long as its bodies differ in temperature; what expands it
/// shows all day.
void straightness_first(std::vector<InvestigatedLine>& lines) {
  std::stable_partition(lines.begin(), lines.end(), [](const InvestigatedLine& line) {
    return !is_rotation(line.sense) && direction_of(line.sense) != line.axis;
  });
}

/// A cause that was taken into the model.
struct FoundCause {
  model::EffectInstance effect;
  double probability = 0.0;
  std::vector<SetMember> set;  ///< with those that these data do not tell from it, likeliest first
};

/// One effect, of which only the sensor is in question.
bool is_of_one_effect(const std::vector<SetMember>& set) {
  return std::all_of(set.begin(), set.end(), [&](const SetMember& member) { return member.name == set.front().name; });
}

bool predicts_better(const Candidate& candidate) {
  return candidate.held_out_rms_um && candidate.held_out_rms_before_um &&
         *candidate.held_out_rms_um < *candidate.held_out_rms_before_um;
}

class Investigator {
 public:
  Investigator(const Model& model, const params::Machine& machine, Workshop& workshop,
               const InvestigationOptions& options)
      : machine_(machine), workshop_(workshop), options_(options), readings_(model), ball_(machine, options.times) {
    lines_ = lines_of_model(model, machine);
    if (follows_temperatures(machine)) straightness_first(lines_);
    waiting_ = lines_;
  }

  Result<Investigation> run() {
    while (result_.steps.size() < kMostRuns) {
      const auto next = next_run();
      if (!next) break;
      ECS_DO(step(*next));
    }
    ECS_DO(add_causes_of_ball());
    if (!diagnosis_) {
      if (!ball_.diagnosis())
        result_.notes.push_back(fmt::format("no measurement: no run fits into {:g} minutes", options_.minutes));
      return std::move(result_);
    }
    result_.verdict = together(verdict(), result_.verdict);
    result_.programme = iso_programme(measured_lines_, machine_, options_.times);
    ECS_DO(add_causes());
    ECS_DO(compensate());
    return std::move(result_);
  }

 private:
  struct Look {
    MeasurementProposal proposal;
    laser::MeasurementSet set;
  };

  /// A line of the first look, measured in another way.
  using Change = std::function<MeasurementProposal(const MeasurementProposal&, const model::MeasuringTimes&)>;

  [[nodiscard]] bool cancelled() const { return options_.cancelled != nullptr && *options_.cancelled; }
  [[nodiscard]] double minutes_left() const { return options_.minutes - result_.minutes; }

  /// Who looks for causes that do not show yet stops where the full programme would have ended.
  [[nodiscard]] double minutes_for_seeing() const {
    const double programme = iso_programme(measured_lines_, machine_, options_.times).minutes;
    return std::min(minutes_left(), programme - result_.minutes);
  }

  /// Nothing: the investigation is over.
  std::optional<MeasurementProposal> next_run() {
    if (diagnosis_ && !waiting_.empty() && !settled() && !finds_nothing() && !follows_temperatures(machine_))
      if (auto here = separating_run(true)) return here;
    while (!waiting_.empty()) {
      const InvestigatedLine line = waiting_.front();
      waiting_.erase(waiting_.begin());
      MeasurementProposal look = look_at(line);
      if (look.minutes <= minutes_left()) return look;
      result_.notes.push_back(
          fmt::format("{} along {} was not measured: {:.0f} minutes were available, {:.0f} are needed",
                      name_of(line.sense), letter_of(line.axis), minutes_left(), look.minutes));
    }
    if (auto later = look_not_repeated()) return later;
    if (auto turned = artefact_not_turned_over()) return turned;
    std::optional<MeasurementProposal> ball = ball_.next(minutes_left());
    if ((ball && !ball_.diagnosis()) || !diagnosis_ || settled()) return ball;
    std::optional<MeasurementProposal> line = separating_run(false);
    return ball && (!line || tells_more_a_minute(*ball, *line)) ? ball : line;
  }

  /// Of two runs with a separation the one with more of it a minute; what has none is a look that comes first.
  static bool tells_more_a_minute(const MeasurementProposal& one, const MeasurementProposal& other) {
    return other.separation_sigma > 0.0 && one.separation_sigma / one.minutes > other.separation_sigma / other.minutes;
  }

  /// Cold and warm where the unit knows temperatures, as long as each line can have as much, twice.
  MeasurementProposal look_at(const InvestigatedLine& line) {
    MeasurementProposal look = first_look(line, machine_, options_.times);
    if (!follows_temperatures(machine_)) return look;
    const double coming = 1.0 + static_cast<double>(waiting_.size());
    const double share =
        (minutes_left() - kShareToSeparate * options_.minutes) / (2.0 * coming + static_cast<double>(looks_.size()));
    if (auto warm = look_cold_and_warm(look, machine_, options_.times, share)) return *warm;
    result_.notes.push_back(fmt::format("{} along {} was not measured warm: {:.0f} minutes are too short for it",
                                        name_of(line.sense), letter_of(line.axis), share));
    return look;
  }

  [[nodiscard]] std::optional<MeasurementProposal> look_not_repeated() const {
    for (const Look& look : looks_) {
      MeasurementProposal later = look_later(look.proposal, machine_);
      if (later.warming && !made_.contains(key_of(later)) && later.minutes <= minutes_left()) return later;
    }
    return std::nullopt;
  }

  /// Several causes at once are believed only after the same lines were measured on other targets as well: on few
  /// targets a sum of two can imitate one.
  [[nodiscard]] bool settled() const {
    if (!says_causes() || !causes_are_single(*diagnosis_)) return false;
    if (diagnosis_->verdict == Verdict::likely_effect && look_not_made(look_between)) return false;
    if (has_aliases() && look_not_made(look_between)) return false;
    const auto named = std::count_if(diagnosis_->candidates.begin(), diagnosis_->candidates.end(),
                                     [](const Candidate& candidate) { return candidate.in_answer(); });
    return named == 1 || !look_not_made(look_between);
  }

  /// Causes that bring the residual down to noise, or the first thought where none is proved.
  [[nodiscard]] bool says_causes() const {
    return diagnosis_->verdict == Verdict::missing_effect || diagnosis_->verdict == Verdict::likely_effect;
  }

  /// Nothing is found: what is left is noise, or looks like it.
  [[nodiscard]] bool finds_nothing() const {
    return diagnosis_->verdict == Verdict::adequate || diagnosis_->verdict == Verdict::cannot_tell;
  }

  /// A period that the targets cannot tell from others, none of them a pitch: its map would be right on these alone.
  [[nodiscard]] bool has_aliases() const {
    return std::any_of(diagnosis_->candidates.begin(), diagnosis_->candidates.end(), [&](const Candidate& candidate) {
      if (!candidate.in_answer() || !candidate.effect.traits().periodic || candidate.parameters_set.empty())
        return false;
      const auto& facts = candidate.effect.axis ? machine_.axes[index_of(*candidate.effect.axis)] : std::nullopt;
      const auto period = candidate.effect.fitted.find(std::string(candidate.effect.definition().searched_parameter()));
      return !facts || period == candidate.effect.fitted.end() || !is_pitch(period->second, *facts);
    });
  }

  /// @param here  only on the line measured last, without waiting, while other lines were not looked at
  std::optional<MeasurementProposal> separating_run(bool here) {
    const bool seeing = finds_nothing();
    if (says_causes() && causes_are_single(*diagnosis_))
      if (auto between = look_not_made(look_between)) return between;
    if (seeing)
      for (const auto& change : {Change(look_in_motion), with_load()})
        if (auto look = look_not_made(change)) return look;
    model::MeasuringTimes times = options_.times;
    times.zeroed_each_run = true;
    const model::NextMeasurement next =
        model::next_measurement(model_so_far(), readings_.observations(machine_), *diagnosis_, times);
    bool too_long = false;
    for (const MeasurementProposal& proposed : next.proposals) {
      const MeasurementProposal proposal = as_looked_at(proposed);
      if (made_.contains(key_of(proposal)) || switches_map(proposal)) continue;
      if (here && (moves_optics(proposal) || proposal.wait_minutes > 0.0)) continue;
      MeasurementProposal whole = with_set_up(seeing ? once(proposal) : proposal);
      if (whole.minutes <= (seeing ? minutes_for_seeing() : minutes_left())) return whole;
      too_long = true;
    }
    if (here) return std::nullopt;
    if (seeing) return line_not_modelled();
    if (auto between = look_not_made(look_between)) return between;
    if (too_long)
      result_.notes.push_back(
          fmt::format("{:.0f} minutes remain, and every separating run needs more", minutes_left()));
    else
      std::copy_if(next.notes.begin(), next.notes.end(), std::back_inserter(result_.notes),
                   [](const std::string& note) { return !is_zero_of_run(note); });
    return std::nullopt;
  }

  /// A line of the first look that was not yet measured in this way, the last one first; only lines on which something
  /// is named, where anything is.
  [[nodiscard]] std::optional<MeasurementProposal> look_not_made(const Change& change) const {
    for (auto look = looks_.rbegin(); look != looks_.rend(); ++look) {
      MeasurementProposal other = change(look->proposal, options_.times);
      if (!moves_optics(other)) other.reversed = last_->reversed;
      other = with_set_up(other);
      if (!made_.contains(key_of(other)) && is_in_question(other) && other.minutes <= minutes_left()) return other;
    }
    return std::nullopt;
  }

  /// In one position the angle error of a square and the squareness of the machine are one figure, which every
  /// diagnosis finds adequate; so are the form of a straight edge and whatever bends the ways.
  [[nodiscard]] std::optional<MeasurementProposal> artefact_not_turned_over() const {
    for (const Look& look : looks_) {
      if (!look.proposal.against_square && !(is_against_straight_edge(look.proposal) && is_named_on(look.proposal)))
        continue;
      MeasurementProposal turned = with_set_up(look_turned_over(look.proposal, options_.times));
      if (!made_.contains(key_of(turned)) && turned.minutes <= minutes_left()) return turned;
    }
    return std::nullopt;
  }

  /// A cause that could as well be the artefact's: what depends on the approach is not.
  [[nodiscard]] bool is_named_on(const MeasurementProposal& line) const {
    return diagnosis_ &&
           std::any_of(diagnosis_->candidates.begin(), diagnosis_->candidates.end(), [&](const Candidate& candidate) {
             return candidate.in_answer() && candidate.effect.axis == line.axis &&
                    candidate.effect.sense == line.sense && !candidate.effect.traits().of_approach;
           });
  }

  /// Turned over on all targets of the first look: on few, two curves are not told apart.
  [[nodiscard]] MeasurementProposal as_looked_at(const MeasurementProposal& proposal) const {
    if (proposal.condition != model::kTurnedOver) return proposal;
    for (const Look& look : looks_)
      if (look.proposal.axis == proposal.axis && look.proposal.sense == proposal.sense)
        return look_turned_over(look.proposal, options_.times);
    return proposal;
  }

  [[nodiscard]] bool is_in_question(const MeasurementProposal& proposal) const {
    bool named = false;
    for (const Candidate& candidate : diagnosis_->candidates) {
      if (!candidate.in_answer()) continue;
      named = true;
      if (candidate.effect.axis == proposal.axis || candidate.effect.sense == proposal.sense) return true;
    }
    return !named;
  }

  /// One run shows whether there is anything to look at.
  [[nodiscard]] MeasurementProposal once(MeasurementProposal proposal) const {
    proposal.runs = 1;
    proposal.minutes = minutes_of(proposal, options_.times);
    return proposal;
  }

  /// The optics are on another line than the one that was measured last.
  [[nodiscard]] bool moves_optics(const MeasurementProposal& proposal) const {
    return !last_ || proposal.axis != last_->axis || proposal.sense != last_->sense ||
           proposal.parked_mm != last_->parked_mm;
  }

  /// A line that was measured before the last one has to be set up again.
  [[nodiscard]] MeasurementProposal with_set_up(MeasurementProposal proposal) const {
    if (!moves_optics(proposal) || proposal.other_line) return proposal;
    const double more = options_.times.line_minutes - options_.times.start_minutes;
    proposal.set_up_minutes += more;
    proposal.minutes += more;
    return proposal;
  }

  /// A line with a load on the machine, which stays on once it was put there.
  [[nodiscard]] Change with_load() const {
    return [is_on = loaded_](const MeasurementProposal& look, const model::MeasuringTimes& times) {
      return look_with_load(look, times, is_on);
    };
  }

  /// Where nothing is missing, the axes of which the model does not speak are looked at as well.
  std::optional<MeasurementProposal> line_not_modelled() {
    if (std::exchange(others_asked_, true)) return std::nullopt;
    waiting_ = other_lines(lines_, machine_);
    return next_run();
  }

  /// The map that was active cannot be switched on and off in the midst of an investigation.
  [[nodiscard]] bool switches_map(const MeasurementProposal& proposal) const {
    const auto& all = readings_.all().readings;
    return proposal.compensated && !all.empty() && all.back().compensated &&
           *proposal.compensated != *all.back().compensated;
  }

  static bool is_against_straight_edge(const MeasurementProposal& proposal) {
    return !is_rotation(proposal.sense) && direction_of(proposal.sense) != proposal.axis && !proposal.against_square;
  }

  /// The line is measured against a square: what a proposal of model/planning does not know.
  [[nodiscard]] bool is_against_square(const MeasurementProposal& proposal) const {
    return std::find(lines_.begin(), lines_.end(), InvestigatedLine{proposal.axis, proposal.sense, true}) !=
           lines_.end();
  }

  /// A set of a ball, after which the optics of a line have to be set up again.
  Result<void> step_of_ball(const MeasurementProposal& proposal) {
    auto run = workshop_.measure({static_cast<int>(result_.steps.size()) + 1, proposal, false});
    last_.reset();
    if (!run) {
      const bool another_may = run.error().kind == ProblemKind::usage || run.error().kind == ProblemKind::refused;
      if (cancelled() || !another_may) return tl::unexpected(run.error());
      result_.notes.push_back(fmt::format("{} could not be measured: {}", short_text(proposal), to_text(run.error())));
      ball_.end();
      return {};
    }
    InvestigationStep step;
    step.minutes = run->minutes;
    step.measured = short_text(as_measured(proposal, run->set));
    step.readings = run->set.readings.size();
    ECS_DO(ball_.add(run->set, diagnosing()));
    step.verdict = ball_.diagnosis()->verdict;
    step.set = members_left(*ball_.diagnosis());
    step.rms_um = ball_.diagnosis()->rms_um;
    keep(std::move(step));
    return {};
  }

  void keep(InvestigationStep step) {
    result_.minutes += step.minutes;
    workshop_.keep(step);
    result_.steps.push_back(std::move(step));
  }

  Result<void> step(MeasurementProposal proposal) {
    if (cancelled()) return stopped();
    if (proposal.ball) return step_of_ball(proposal);
    proposal.against_square = is_against_square(proposal);
    const bool first = proposal.condition.starts_with(kFirstLook);
    auto run = workshop_.measure({static_cast<int>(result_.steps.size()) + 1, proposal, false});
    made_.insert(key_of(proposal));
    last_ = proposal;
    if (!run) {
      const bool another_may = run.error().kind == ProblemKind::usage || run.error().kind == ProblemKind::refused;
      if (cancelled() || !another_may || (first && !diagnosis_)) return tl::unexpected(run.error());
      result_.notes.push_back(fmt::format("{} could not be measured: {}", short_text(proposal), to_text(run.error())));
      return {};
    }
    loaded_ = proposal.load_kg.value_or(loaded_ ? 1.0 : 0.0) > 0.0;
    if (first) {
      looks_.push_back({proposal, run->set});
      measured_lines_.push_back({proposal.axis, proposal.sense, proposal.against_square});
    }
    InvestigationStep step;
    step.minutes = run->minutes;
    step.measured = short_text(as_measured(proposal, run->set));
    step.readings = run->set.readings.size();
    readings_.add(std::move(run->set), proposal.set_up_minutes + proposal.wait_minutes, proposal.against_square);
    ECS_DO(diagnose());
    step.verdict = verdict();
    for (const FoundCause& cause : accepted_) step.set.push_back({to_text(cause.effect), cause.probability});
    std::ranges::move(members_left(*diagnosis_), std::back_inserter(step.set));
    step.rms_um = diagnosis_->rms_um;
    keep(std::move(step));
    return {};
  }

  Result<void> diagnose() {
    accepted_.clear();
    if (follows_temperatures(machine_))
      for (const Sense sense : readings_.senses()) ECS_DO(accept_proved(sense));
    ECS_TRY(diagnosis, model::diagnose(model_so_far(), readings_.observations(machine_), diagnosing()));
    diagnosis_ = std::move(diagnosis);
    return {};
  }

  [[nodiscard]] model::DiagnoseOptions diagnosing() const {
    model::DiagnoseOptions options;
    options.cancelled = options_.cancelled;
    return options;
  }

  /// A diagnosis seeks few causes at once; heat brings one and more a line. So what follows the temperatures that the
  /// unit knows is sought sense by sense, and taken into the model as long as it is proved without a rival there, or
  /// predicts readings left out and only its sensor is in question: two bodies may warm alike. The
  /// rest, clock and other sensors among it, is diagnosed beside that. What a sensor explains is not sought in the
  /// clock: a machine that warms up from the cold does both alike. What it explains but for a delay of the sensor is
  /// told from noise only beside the clock.
  Result<void> accept_proved(Sense sense) {
    Model model = model_so_far();
    std::erase_if(model.effects, [&](const model::EffectInstance& effect) {
      if (!effect.is_user()) return effect.sense && effect.sense != sense;
      return std::none_of(effect.formulas.begin(), effect.formulas.end(),
                          [&](const model::UserFormula& formula) { return formula.sense == sense; });
    });
    for (const bool clock : {false, true}) {
      const model::Observations known = readings_.observations_of_unit(machine_, sense, clock);
      for (std::size_t before = 0; before != model.effects.size();) {
        before = model.effects.size();
        ECS_TRY(diagnosis, model::diagnose(model, known, diagnosing()));
        accept_proved(diagnosis, clock, model);
      }
    }
    return {};
  }

  /// @param clock  only what follows inputs
  void accept_proved(const Diagnosis& diagnosis, bool clock, Model& model) {
    for (const Candidate& candidate : diagnosis.candidates) {
      const bool follows = follows_inputs(candidate.effect);
      const bool whichever_sensor = !clock && follows && candidate.in_answer() && predicts_better(candidate) &&
                                    is_of_one_effect(credible_set_of(candidate));
      if (!whichever_sensor && (!is_proved_alone(candidate) || (clock && !follows))) continue;
      model.effects.push_back(at_its_value(candidate.effect));
      if (follows) accepted_.push_back({model.effects.back(), candidate.probability, credible_set_of(candidate)});
    }
  }

  static bool is_proved_alone(const Candidate& candidate) {
    return candidate.named && credible_set_of(candidate).size() == 1;
  }

  /// A row that follows the wrong temperature, or the clock, adds an error as soon as the day takes another course.
  [[nodiscard]] bool is_added(const Candidate& candidate) const {
    if (!candidate.in_answer()) return false;
    const auto& definition = candidate.effect.definition();
    if (!follows_temperatures(machine_) || (definition.live.empty() && !definition.has_need(model::Need::time)))
      return true;
    return is_proved_alone(candidate) || candidate.probability >= kProbable;
  }

  /// The unit knows the temperatures that the effect follows.
  [[nodiscard]] bool follows_inputs(const model::EffectInstance& effect) const {
    const auto& live = effect.definition().live;
    return is_carried(effect, machine_) && std::any_of(live.begin(), live.end(), [](const model::LiveTerm& row) {
             return row.source == model::LiveSource::sensor || row.source == model::LiveSource::material ||
                    row.source == model::LiveSource::difference;
           });
  }

  [[nodiscard]] Model model_so_far() const {
    Model model = readings_.model_with_zeros();
    for (const FoundCause& cause : accepted_) model.effects.push_back(cause.effect);
    return model;
  }

  /// Of the base model: the causes that were taken into it are missing there.
  [[nodiscard]] Verdict verdict() const {
    if (accepted_.empty() || diagnosis_->verdict == Verdict::missing_effect) return diagnosis_->verdict;
    return diagnosis_->verdict == Verdict::adequate ? Verdict::missing_effect : Verdict::partly_explained;
  }

  /// Of the lines and of the ball: what is missing on either is missing.
  static Verdict together(Verdict lines, const std::optional<Verdict>& ball) {
    if (!ball || *ball == lines || *ball == Verdict::adequate) return lines;
    return lines == Verdict::adequate ? *ball : Verdict::partly_explained;
  }

  Result<void> add_causes_of_ball() {
    if (!ball_.diagnosis()) return {};
    result_.verdict = ball_.diagnosis()->verdict;
    ECS_TRY(causes, ball_.causes());
    result_.causes = std::move(causes.found);
    result_.ball_model = std::move(causes.model);
    return {};
  }

  Result<void> add_causes() {
    const model::Observations data = readings_.observations(machine_);
    Model whole = model_so_far();
    std::vector<FoundCause> added = accepted_;
    for (const Candidate& candidate : diagnosis_->candidates) {
      if (!is_added(candidate)) {
        if (candidate.in_answer())
          result_.notes.push_back(fmt::format(
              "{} is not in the model: its probability is {:.0f} %; effects of temperature or time need {:.0f} %",
              to_text(candidate.effect), 100.0 * candidate.probability, 100.0 * kProbable));
        continue;
      }
      ECS_TRY(with, model::add_effect(whole, data, model::request_of(candidate.effect), ""));
      whole = std::move(with.model);
      whole.effects.back() = at_its_value(candidate.effect);
      added.push_back({whole.effects.back(), candidate.probability, credible_set_of(candidate)});
    }
    for (const FoundCause& cause : added) free_again(whole, cause.effect);
    ECS_TRY(fit, model::fit(whole, data));
    std::vector<model::EffectFit> fits = fit.effects;
    for (const FoundCause& cause : added) {
      const auto one = std::ranges::find_if(
          fits, [&](const model::EffectFit& each) { return same_candidate(each.effect, cause.effect); });
      if (one == fits.end()) continue;
      result_.causes.push_back({to_text(cause.effect), one->parameters, cause.probability, one->rms_um, cause.set});
      fits.erase(one);  // two waves along one line have one name
    }
    std::stable_sort(result_.causes.begin(), result_.causes.end(),
                     [](const auto& a, const auto& b) { return a.rms_um > b.rms_um; });
    result_.model = without_zeros(model::with_values(std::move(whole), fit));
    for (const Look& look : looks_)
      if (is_against_straight_edge(look.proposal))
        ECS_DO(make_level(result_.model, {look.proposal.axis, look.proposal.sense}, machine_));
    return {};
  }

  Result<void> compensate() {
    ECS_TRY(before, rms_of_looks());
    result_.rms_before_um = before;
    if (cancelled()) return stopped();
    if (was_compensated()) {
      result_.notes.emplace_back(
          "not compensated: a map was active while the lines were measured; a new map would have to include both");
      return {};
    }
    if (auto active = workshop_.activate(result_.model); !active) {
      if (cancelled() || active.error().kind == ProblemKind::link) return tl::unexpected(active.error());
      result_.notes.push_back("not compensated: " + to_text(active.error()));
      return {};
    }
    int number = static_cast<int>(result_.steps.size());
    for (Look& look : looks_) {
      if (cancelled()) return stopped();
      MeasurementProposal again = look.proposal;
      again.condition = "with the new map";
      if (loaded_) again.load_kg = 0.0;
      ECS_TRY(run, workshop_.measure({++number, again, true}));
      look.set = std::move(run.set);
      result_.compensated_minutes += run.minutes;
    }
    ECS_TRY(after, rms_of_looks());
    result_.rms_compensated_um = after;
    return {};
  }

  [[nodiscard]] bool was_compensated() const {
    const auto& all = readings_.all().readings;
    return std::any_of(all.begin(), all.end(), [](const laser::Reading& r) { return r.compensated.value_or(false); });
  }

  /// Without the zero of each run, the slope of a straight edge, and what was found to be the artefact's: these say
  /// nothing of the machine.
  [[nodiscard]] Result<double> rms_of_looks() const {
    double squares = 0.0, count = 0.0;
    for (const Look& look : looks_) {
      ECS_TRY(artefact, errors_of_artefact(look.set));
      squares += squares_about_zero(look, artefact);
      count += static_cast<double>(look.set.readings.size());
    }
    return std::sqrt(squares / std::max(count, 1.0));
  }

  /// About the mean of the readings; of a straight edge about a straight line (least squares).
  [[nodiscard]] static double squares_about_zero(const Look& look, const std::vector<double>& artefact_um) {
    const auto readings = static_cast<double>(look.set.readings.size());
    const bool straight_edge = is_against_straight_edge(look.proposal);
    double place = 0.0, mean = 0.0, moment = 0.0, inertia = 0.0, squares = 0.0;
    const auto error_um = [&](std::size_t k) { return look.set.readings[k].error - artefact_um[k]; };
    for (std::size_t k = 0; k < artefact_um.size(); ++k) {
      place += target_mm(look.set.readings[k]) / readings;
      mean += error_um(k) / readings;
    }
    for (std::size_t k = 0; k < artefact_um.size(); ++k) {
      const double arm_mm = target_mm(look.set.readings[k]) - place;
      moment += arm_mm * error_um(k);
      inertia += arm_mm * arm_mm;
      squares += (error_um(k) - mean) * (error_um(k) - mean);
    }
    return straight_edge && inertia > 0.0 ? std::max(0.0, squares - moment * moment / inertia) : squares;
  }

  /// What the artefacts of the model give to these readings.
  [[nodiscard]] Result<std::vector<double>> errors_of_artefact(const laser::MeasurementSet& set) const {
    Model artefacts = result_.model;
    std::erase_if(artefacts.effects, [](const model::EffectInstance& effect) { return !is_of_artefact(effect); });
    std::vector<double> values(set.readings.size());
    if (artefacts.effects.empty()) return values;
    laser::MeasurementSet numbered = set;
    for (std::size_t k = 0; k < numbered.readings.size(); ++k) numbered.readings[k].row = static_cast<int>(k) + 1;
    const model::Observations at = model::observations_of(numbered, artefacts, machine_);
    ECS_TRY(predicted, model::predicted(artefacts, at));
    for (std::size_t k = 0; k < at.size(); ++k) values[static_cast<std::size_t>(at.row[k] - 1)] = predicted[k];
    return values;
  }

  static bool is_of_artefact(const model::EffectInstance& effect) {
    return effect.definition().has_need(model::Need::reversed);
  }

  const params::Machine& machine_;
  Workshop& workshop_;
  const InvestigationOptions& options_;
  InvestigationReadings readings_;
  BallInvestigation ball_;
  std::vector<InvestigatedLine> lines_, waiting_, measured_lines_;
  std::vector<Look> looks_;
  std::set<RunKey> made_;
  std::optional<MeasurementProposal> last_;
  std::optional<Diagnosis> diagnosis_;  ///< beside what was accepted
  std::vector<FoundCause> accepted_;    ///< what follows inputs, by its sense alone
  bool others_asked_ = false;
  bool loaded_ = false;  ///< a load was put on the machine, and is there still
  Investigation result_;
};

}  // namespace

Result<Investigation> investigate(const model::Model& model, const params::Machine& machine, Workshop& workshop,
                                  const InvestigationOptions& options) {
  return Investigator(model, machine, workshop, options).run();
}

}  // namespace ecs::commissioning
