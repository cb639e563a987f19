// What is done to a model on the MODEL screen, as commands of `ecs model` and as records of what was done. The screen
// changes the model in memory and writes it once, so the commands since then are noted when it is written.
#pragma once

#include <string>
#include <vector>

#include "commissioning/maps/from_model.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/ladder.hpp"

namespace ecs::commissioning {

class ModelCommands {
 public:
  using Words = std::vector<std::string>;
  ModelCommands() = default;
  explicit ModelCommands(ModelArguments files) : files_(std::move(files)) {}

  // what a step of the ladder is as a command; the model is changed in place
  /// @param name  "cyclic:X:EX"  @param alternatives  as the effect keeps them, with commas between them
  [[nodiscard]] Words add(const std::string& name, const model::AddRequest& request,
                          const std::string& alternatives) const;
  [[nodiscard]] Words remove(const std::string& name) const;
  [[nodiscard]] Words decide(const std::string& name) const;
  [[nodiscard]] Words fit() const;
  /// Of an effect that stood in the file already: `ecs model undo` takes it back.
  [[nodiscard]] static Words added_before() { return {"model", "add"}; }

  /// A step was done. Empty words: no command does it, the file is noted as it is when it is written.
  void did(const Words& words);
  void undid(const Words& words);
  void did_again(const Words& words);

  // noted at once
  void begun() const;
  /// The file was written: all since the last time. @param toml  as it is now
  void saved(const std::string& toml);
  /// @param changed  the model is not as its file is: then a command would look at another one
  void diagnosed(bool changed) const;
  void looked_after(bool changed, const std::vector<std::string>& measured_again) const;
  void drawn(bool changed, const std::string& picture) const;
  void note_map(const FromModelArguments& arguments, const std::string& params) const;

 private:
  /// {"model", verb}, model, data, machine and import options.
  [[nodiscard]] Words on_data(const std::string& verb) const;
  [[nodiscard]] Words undo() const;
  ModelArguments files_;
  std::vector<Words> steps_;  ///< since the file was written
  bool lost_ = false;         ///< what was done since then is more than commands do
};

void record_saved_model(const ModelArguments& files, const model::Model& model);

/// @param model  as it was when the diagnosis began
void record_diagnosis(const ModelArguments& files, const model::Model& model, const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
