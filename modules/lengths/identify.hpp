// The 21 components of a machine from lengths: weighted least squares, what is determined and how well, what is not and
// why. Sources: W. Knapp and others, ISO 230-6 and ISO 230-2 for lines; H. Schwenke, M. Franke, J. Hannaford,
// H. Kunzmann, Error mapping of CMMs and machine tools by a single tracking interferometer, CIRP Annals 54 (2005) 475;
// K. Umetsu and others, Meas. Sci. Technol. 16 (2005) 2466. Variance of the noise: restricted maximum likelihood
// (H. D. Patterson, R. Thompson, Biometrika 58 (1971) 545), and what it costs that it is an estimate
// (shared_noise.hpp). Does not live here: files (length_test.hpp), the map (lengths_verbs.cpp), plans
// (plan_lengths.hpp).
#pragma once

#include <string>
#include <vector>

#include "modules/lengths/curves.hpp"

namespace ecs::model {

struct IdentifySettings {
  PerAxis<std::optional<double>> knots_mm{};  ///< in place of those of the file
  int reversal_degree = 1;                    ///< −1: the approach does not matter
  double scale_um_per_m = 0.1;                ///< of each set-up (air, wavelength), standard deviation; 0: none
  std::array<bool, kComponents> zero{};       ///< declared zero
  bool keep_outliers = false;
};

struct IdentifiedCurve {
  Component component = Component::EXX;
  bool acts = false;                         ///< at the tool, with one of the tools used
  bool determined = false;                   ///< then the rest holds
  std::string why_not;                       ///< in words, where it acts and is not determined
  std::vector<double> position_mm;           ///< even, both ends of the travel among them
  std::vector<double> forward, reverse;      ///< error [um, um/m]
  std::vector<double> u_forward, u_reverse;  ///< standard uncertainties (k = 1)
  std::vector<double> U_forward, U_reverse;  ///< 95 %: Student's t with the degrees of freedom of each value
  double u_finer = 0.0;                      ///< of it, form finer than the knots (k = 1)
  double degrees_of_freedom = 0.0;           ///< of the mean of their squares
  double value = 0.0;                        ///< as the header of a map states it: of each value on its own
  double pass = 0.0;                         ///< and common to the table
};

struct IdentifiedSquareness {
  Component component = Component::C0Y;
  bool acts = false;
  bool determined = false;
  std::string why_not;
  double um_per_m = 0.0, u_um_per_m = 0.0;
  double U_um_per_m = 0.0;  ///< 95 %
  double degrees_of_freedom = 0.0;
};

struct IdentifiedSetUp {
  std::string name;
  std::size_t readings = 0;
  Vector3 station_correction_mm{};         ///< of the first tool; 0 for an interferometer; of points the translation
  std::optional<Vector3> turned_um_per_m;  ///< of points: rotation of the placement about its first point
  double rms_um = 0.0;                     ///< of the residuals
};

struct LengthOutlier {
  int line = 0;  ///< of the file
  double residual_um = 0.0;
  double sigmas = 0.0;
};

struct Identification {
  std::vector<IdentifiedCurve> curves;           ///< 18
  std::vector<IdentifiedSquareness> squareness;  ///< 3
  std::vector<IdentifiedSetUp> set_ups;
  std::vector<LengthOutlier> outliers;  ///< left out, unless they were to be kept
  std::size_t readings = 0;             ///< used
  int unknowns = 0;                     ///< determined
  int known_values = 0;        ///< scales of set-ups and length of the bar: unknowns that also count as observations
  int degrees_of_freedom = 0;  ///< readings + known_values - unknowns
  double residual_um = 0.0;    ///< standard deviation of a single reading: instrument and what does not repeat
  double white_um = 0.0;       ///< of it, of each reading on its own
  double stop_um = 0.0;        ///< of it, of a stop, kept while the axis is parked: of each translation
  double stop_um_per_m = 0.0;  ///< the same of each angle
  double pass_um = 0.0;        ///< of it, common to a pass of an axis: of each translation
  double pass_um_per_m = 0.0;  ///< the same of each angle
  std::optional<double> repeat_um;    ///< of a single reading, from poses measured again in other runs
  std::optional<double> volume_um;    ///< √(mean squared standard uncertainty) over the volume (k = 1), first tool
  std::optional<double> volume_U_um;  ///< the same, 95 %
  PerAxis<double> knots_mm{};         ///< that were used
  std::vector<std::string> contradictions;  ///< declared zeros that the lengths show not to be; in the notes as well
  std::vector<std::string> notes;
  /// Everything that acts is determined.
  [[nodiscard]] bool whole() const;
};

/// Refused: another machine or chain, poses outside the travel, fewer readings than unknowns.
[[nodiscard]] Result<Identification> identify(const LengthTest& test, const params::Machine& machine,
                                              const IdentifySettings& settings);

/// Standard deviation of a single reading [um], from poses that were measured in several runs; nothing with too few.
[[nodiscard]] std::optional<double> repeats_of(const LengthTest& test);

/// Spacing of knots for a file: as asked, else as its head says, else twice its spacing of coordinates and at most
/// twelve intervals.
[[nodiscard]] PerAxis<double> knots_for(const LengthTest& test, const LengthMachine& machine,
                                        const PerAxis<std::optional<double>>& asked);

/// Why a component is not determined, in the words of the trade: what the lengths lack.
/// @param together_with  components that the lengths hold only in combination with it
[[nodiscard]] std::string what_is_missing(Component component, const LengthTest& test, const MachineCurves& curves,
                                          const Eigen::MatrixXd& direction,
                                          const std::vector<Component>& together_with);

}  // namespace ecs::model
