#include "app/screens/model_desk.hpp"

#include <map>
#include <tuple>

#include <fmt/format.h>

#include "app/model_plots.hpp"
#include "app/plot_gnuplot.hpp"

namespace ecs::app {
namespace {

using model::Fit;
using model::Observations;

constexpr std::array<int, 3> kApproaches{1, -1, 0};

std::string_view approach_word(int approach) { return approach > 0 ? "forward" : (approach < 0 ? "reverse" : "any"); }
Mark reading_mark(int approach) {
  return approach > 0 ? Mark::forward_reading : (approach < 0 ? Mark::reverse_reading : Mark::reading);
}
Mark line_mark(int approach) { return approach > 0 ? Mark::forward : (approach < 0 ? Mark::reverse : Mark::both); }

PlotSeries means_of(const Observations& data, const MeasuredLine& line, const std::vector<double>& value, int approach,
                    const std::string& name) {
  std::map<double, std::pair<double, double>> sums;
  for (const std::size_t k : line.rows) {
    if (data.approach[k] != approach) continue;
    auto& [sum, count] = sums[data.position_mm[k][index_of(line.axis)]];
    sum += value[k];
    count += 1.0;
  }
  PlotSeries series{name, line_mark(approach), {}};
  for (const auto& [x, sum] : sums) series.points.push_back({x, sum.first / sum.second});
  return series;
}

PlotSeries readings_of(const Observations& data, const MeasuredLine& line, const std::vector<double>& value,
                       int approach, const std::string& name) {
  PlotSeries series{name, reading_mark(approach), {}};
  for (const std::size_t k : line.rows)
    if (data.approach[k] == approach) series.points.push_back({data.position_mm[k][index_of(line.axis)], value[k]});
  return series;
}

PlotPanel panel_of(const Observations& data, const MeasuredLine& line, const std::vector<double>& signs,
                   const std::vector<double>& lines, const std::string& title) {
  const std::string unit = is_rotation(line.sense) ? "um/m" : "um";
  PlotPanel panel{title, fmt::format("{} mm", letter_of(line.axis)), unit, {}};
  for (const int approach : kApproaches) {
    PlotSeries series = readings_of(data, line, signs, approach, "");
    if (!series.points.empty()) panel.series.push_back(std::move(series));
  }
  for (const int approach : kApproaches) {
    PlotSeries series = means_of(data, line, lines, approach, std::string(approach_word(approach)));
    if (!series.points.empty()) panel.series.push_back(std::move(series));
  }
  return panel;
}

}  // namespace

std::vector<MeasuredLine> measured_lines(const Observations& data) {
  std::map<std::tuple<Sense, Axis, Vector3>, MeasuredLine> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    Vector3 parked = data.position_mm[k];
    parked[index_of(data.axis[k])] = 0.0;
    MeasuredLine& line = lines[{data.sense[k], data.axis[k], parked}];
    line.axis = data.axis[k];
    line.sense = data.sense[k];
    line.parked_mm = parked;
    line.rows.push_back(k);
  }
  std::vector<MeasuredLine> list;
  for (auto& [key, line] : lines) list.push_back(std::move(line));
  return list;
}

std::string title_of(const MeasuredLine& line) {
  std::string text = fmt::format("{} along {}", name_of(line.sense), letter_of(line.axis));
  std::string joint = " at ";
  for (const Axis a : kAllAxes)
    if (a != line.axis && line.parked_mm[index_of(a)] != 0.0) {
      text += fmt::format("{}{} {:g}", joint, letter_of(a), line.parked_mm[index_of(a)]);
      joint = ", ";
    }
  return text;
}

PlotPanel measured_panel(const Observations& data, const Fit& fit, const MeasuredLine& line) {
  return panel_of(data, line, data.reading, fit.predicted, title_of(line) + ": measured (dots), model (lines)");
}

PlotPanel residual_panel(const Observations& data, const Fit& fit, const MeasuredLine& line) {
  return panel_of(data, line, fit.residual, fit.residual, "what the model leaves");
}

Result<std::unique_ptr<ModelDesk>> ModelDesk::open(Session& session, const ModelArguments& files) {
  auto work = model_work(session, files);
  if (!work) return tl::unexpected(work.error());
  std::unique_ptr<ModelDesk> desk(new ModelDesk);
  desk->files_ = files;
  desk->work_ = std::make_shared<ModelWork>(std::move(*work));
  desk->data_ = std::make_shared<const Observations>(std::move(desk->work_->data));
  desk->lines_ = measured_lines(*desk->data_);
  auto fit = model::fit(desk->work_->model, *desk->data_);
  if (!fit) return tl::unexpected(in_file(fit.error(), files.model));
  desk->fit_ = std::move(*fit);
  return desk;
}

void ModelDesk::say(std::string text, bool problem) {
  message_ = std::move(text);
  message_is_problem_ = problem;
}

double ModelDesk::seconds_working() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count();
}

bool ModelDesk::refit(model::Model model) {
  auto fit = model::fit(model, *data_);
  if (!fit) {
    say(to_text(fit.error()), true);
    return false;
  }
  fit_ = std::move(*fit);
  work_->model = std::move(model);
  diagnosis_.reset();
  next_.reset();
  changed_ = true;
  return true;
}

void ModelDesk::start_diagnosis() {
  if (busy()) return;
  working_on_ = "looking for what is missing";
  since_ = std::chrono::steady_clock::now();
  cancelled_ = false;
  say("");
  diagnosing_.start([model = work_->model, data = data_](JobSigns&) {
    Diagnosed found{model::diagnose(model, *data), {}};
    if (found.diagnosis) found.next = model::next_measurement(model, *data, *found.diagnosis);
    return found;
  });
}

void ModelDesk::start_adding(std::size_t candidate) {
  if (busy() || !diagnosis_ || candidate >= diagnosis_->candidates.size()) return;
  const model::EffectInstance& effect = diagnosis_->candidates[candidate].effect;
  model::AddRequest request{effect.id,       effect.axis,   effect.sense, effect.code,
                            effect.approach, effect.sensor, effect.name};
  working_on_ = "adding " + to_text(effect);
  since_ = std::chrono::steady_clock::now();
  cancelled_ = false;
  say("");
  adding_.start([model = work_->model, data = data_, request, name = work_->data_name](JobSigns&) {
    return model::add_effect(model, *data, request, name);
  });
}

void ModelDesk::undo() {
  if (busy()) return;
  auto before = model::undo(work_->model);
  if (!before) return say(to_text(before.error()), true);
  const std::string taken = work_->model.history.empty() ? "" : work_->model.history.back().effect;
  if (refit(std::move(*before))) say("taken back: " + taken);
}

void ModelDesk::save() {
  const auto kept = keep_model(files_.model, work_->model, files_.model);
  if (!kept) return say(to_text(kept.error()), true);
  changed_ = false;
  say("written to " + files_.model);
}

void ModelDesk::export_picture(const std::string& path) {
  const auto written = write_plot(path, fit_figure(fit_, *data_, files_.model));
  if (!written) return say(to_text(written.error()), true);
  say("picture written to " + path);
}

void ModelDesk::cancel() {
  if (!busy()) return;
  cancelled_ = true;
  say("given up: what is found will not be shown");
}

bool ModelDesk::advance() {
  if (auto found = diagnosing_.take()) {
    if (cancelled_) return true;
    if (!found->diagnosis) {
      say(to_text(found->diagnosis.error()), true);
      return true;
    }
    diagnosis_ = std::move(*found->diagnosis);
    next_ = std::move(found->next);
    return true;
  }
  if (auto added = adding_.take()) {
    if (cancelled_) return true;
    if (!*added) {
      say(to_text(added->error()), true);
      return true;
    }
    const double before_um = (*added)->rms_before_um, after_um = (*added)->rms_after_um;
    const std::string name = to_text((*added)->effect.effect);
    if (refit(std::move((*added)->model)))
      say(fmt::format("added {}: {:.3f} -> {:.3f} um rms; u takes it back, s writes the model", name, before_um,
                      after_um));
    return true;
  }
  return busy();
}

}  // namespace ecs::app
