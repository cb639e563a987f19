// Noise of readings by its laws.
#include <cmath>
#include <map>

#include "bench/foreign/case.hpp"

namespace foreign {

Noise draw_noise(Random& random) {
  Noise noise;
  noise.sigma_um = random.between_log(0.15, 2.0);
  noise.law = random.pick(std::vector<std::string>{"white", "white", "rounded", "ar", "heavy", "outliers"});
  if (noise.law == "ar") noise.correlation = random.between(0.2, 0.75);
  if (noise.law == "rounded") noise.step_um = noise.sigma_um * random.between(0.5, 2.0);
  return noise;
}

Column draw_noise_um(Random& random, const Setup& setup, const Noise& noise) {
  Column values;
  std::map<std::string, double> last;
  int run = 0;
  const double gaussian = noise.law == "rounded"
                              ? std::sqrt(noise.sigma_um * noise.sigma_um - noise.step_um * noise.step_um / 12.0)
                              : noise.sigma_um;
  constexpr double kOutlierShare = 0.015;
  constexpr double kOutlierSize = 6.0;
  for (const Reading& reading : setup.readings) {
    if (reading.run != run) last.clear();
    run = reading.run;
    double value = random.normal();
    if (noise.law == "heavy") value = random.heavy(4);
    if (noise.law == "outliers" && random.chance(kOutlierShare)) value *= kOutlierSize;
    if (noise.law == "ar") {
      const auto [at, fresh] = last.try_emplace(reading.sense, value);
      if (!fresh) at->second = noise.correlation * at->second + std::sqrt(1.0 - std::pow(noise.correlation, 2)) * value;
      value = at->second;
    }
    values.push_back(gaussian * value);
  }
  return values;
}

Column whitened(const Setup& setup, const Noise& noise, const Column& values) {
  Column white(values.size());
  if (noise.correlation == 0.0) {
    for (std::size_t i = 0; i < values.size(); ++i) white[i] = values[i] / noise.sigma_um;
    return white;
  }
  std::map<std::string, std::size_t> last;
  int run = 0;
  const double rho = noise.correlation;
  const double fresh_share = std::sqrt(1.0 - rho * rho);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Reading& reading = setup.readings[i];
    if (reading.run != run) last.clear();
    run = reading.run;
    const auto before = last.find(reading.sense);
    white[i] = before != last.end() ? (values[i] - rho * values[before->second]) / fresh_share : values[i];
    white[i] /= noise.sigma_um;
    last[reading.sense] = i;
  }
  return white;
}

}  // namespace foreign
