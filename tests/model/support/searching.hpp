// A search on a small measured set: offset and scale absorbed, noise known.
#pragma once

#include <string>
#include <vector>

#include "model/diagnosis/ladder.hpp"
#include "model/fit/search.hpp"
#include "tests/model/support/measured_lines.hpp"

namespace ecs::model::test {

/// "step:X:EX" at its place; sensor and values left open.
inline EffectInstance candidate(const char* text, std::string sensor = "") {
  const AddRequest request = parse_add_request(text).value();
  EffectInstance one = effect(request.id, *request.axis, request.sense.value_or(Sense::EX));
  one.code = request.code;
  if (one.code) one.sense.reset();
  one.sensor = std::move(sensor);
  return one;
}

inline std::vector<EffectInstance> candidates_named(std::initializer_list<const char*> texts) {
  std::vector<EffectInstance> list;
  for (const char* text : texts) list.push_back(candidate(text));
  return list;
}

inline constexpr double kSigma_um = 0.2;
inline laser::MeasurementSet measured_line(const Truth& truth, unsigned seed = 1) {
  return measured({}, kSigma_um, truth, seed);
}

/// Everything that a search refers to.
struct Searching {
  Observations data;
  Regressors regressors;
  NoiseModel noise;
  Whitener whitener;
  Eigen::MatrixXd base;
  Eigen::VectorXd target;
  Search search;

  Searching(const laser::MeasurementSet& set, double noise_um, const std::vector<EffectInstance>& candidates,
            const std::atomic<bool>* cancelled = nullptr)
      : data(observations_of(set, straight(), mill())),
        regressors(data),
        noise(plain_noise(data, noise_um)),
        whitener(data, noise, std::vector<bool>(data.size(), false)),
        base(static_cast<Eigen::Index>(data.size()), 2),
        target(Eigen::Map<const Eigen::VectorXd>(data.reading.data(), static_cast<Eigen::Index>(data.size()))),
        search(regressors, whitener, offset_and_scale(), target, candidates, {}, cancelled) {}

  [[nodiscard]] std::string name_of(const Choice& choice) const {
    return to_text(search.families()[choice.family].effect);
  }
  [[nodiscard]] std::vector<std::string> names_of(const std::vector<Choice>& chosen) const {
    std::vector<std::string> names;
    for (const Choice& choice : chosen) names.push_back(name_of(choice));
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  const Eigen::MatrixXd& offset_and_scale() {
    for (std::size_t k = 0; k < data.size(); ++k) {
      base(static_cast<Eigen::Index>(k), 0) = 1.0;
      base(static_cast<Eigen::Index>(k), 1) = data.p_mm(k, Axis::X);
    }
    return base;
  }
};

}  // namespace ecs::model::test
