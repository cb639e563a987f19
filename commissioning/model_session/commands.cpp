#include "commissioning/model_session/commands.hpp"

#include "base/answer_table.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/records.hpp"

namespace ecs::commissioning {
namespace {

using Words = ModelCommands::Words;

void add_option(Words& words, const char* name, const std::string& value) {
  if (!value.empty()) words.insert(words.end(), {name, value});
}

}  // namespace

Words ModelCommands::on_data(const std::string& verb) const {
  Words words{"model", verb, path_word(files_.model)};
  for (const std::string& file : files_.data) words.push_back(path_word(file));
  add_option(words, "--machine", path_word(files_.machine));
  const Words import = import_words(files_.import);
  words.insert(words.end(), import.begin(), import.end());
  return words;
}

Words ModelCommands::add(const std::string& name, const model::AddRequest& request,
                         const std::string& alternatives) const {
  Words words{"model", "add", path_word(files_.model), name, "--data"};
  for (const std::string& file : files_.data) words.push_back(path_word(file));
  if (request.approach) add_option(words, "--approach", std::string(model::name_of(*request.approach)));
  add_option(words, "--sensor", request.sensor);
  add_option(words, "--sensor2", request.sensor2);
  if (request.sense) add_option(words, "--sense", std::string(name_of(*request.sense)));
  if (request.code) add_option(words, "--code", std::string(name_of(*request.code)));
  add_option(words, "--machine", path_word(files_.machine));
  for (const std::string& one : model::alternatives_in(alternatives))
    if (one.find('@') == std::string::npos) add_option(words, "--or", one);
  for (std::string& word : import_words(files_.import))
    words.push_back(word == "--sense" ? "--reading-sense" : std::move(word));
  add_option(words, "-o", path_word(files_.model));
  return words;
}

Words ModelCommands::remove(const std::string& name) const {
  Words words = on_data("remove");
  words.insert(words.begin() + 2, name);
  return words;
}

Words ModelCommands::decide(const std::string& name) const {
  return {"model", "decide", name, path_word(files_.model)};
}

Words ModelCommands::fit() const {
  Words words = on_data("fit");
  add_option(words, "-o", path_word(files_.model));
  return words;
}

Words ModelCommands::undo() const {
  Words words{"model", "undo", path_word(files_.model)};
  add_option(words, "--machine", path_word(files_.machine));
  return words;
}

void ModelCommands::did(const Words& words) {
  lost_ = lost_ || words.size() <= added_before().size();
  steps_.push_back(words);
}

/// What was done since the file was written is left out; before that it is taken back by a command where one does it.
void ModelCommands::undid(const Words& words) {
  if (!steps_.empty() && steps_.back() == words) {
    steps_.pop_back();
    return;
  }
  lost_ = lost_ || words.size() < 2 || words[1] != "add";
  steps_.push_back(undo());
}

void ModelCommands::did_again(const Words& words) {
  if (!steps_.empty() && steps_.back() == undo())
    steps_.pop_back();
  else
    did(words);
}

void ModelCommands::begun() const { note_command(on_data("new")); }

void ModelCommands::saved(const std::string& toml) {
  if (lost_) {
    note_file(files_.model, toml);
  } else {
    for (const Words& words : steps_) note_command(words);
    note_command(fit());
  }
  steps_.clear();
  lost_ = false;
}

void ModelCommands::diagnosed(bool changed) const {
  if (changed) return note_remark("diagnosed here, with changes of the model that are not saved yet");
  note_command(on_data("diagnose"));
}

void ModelCommands::looked_after(bool changed, const std::vector<std::string>& measured_again) const {
  if (changed) return note_remark("what-if computed here, with changes of the model that are not saved yet");
  Words words = on_data("what-if");
  if (!measured_again.empty()) words.emplace_back("--after");
  for (const std::string& file : measured_again) words.push_back(path_word(file));
  note_command(std::move(words));
}

void ModelCommands::drawn(bool changed, const std::string& picture) const {
  if (changed) return note_remark("the picture " + picture + " shows a model with changes that are not saved yet");
  Words words = on_data("fit");
  add_option(words, "--plot", path_word(picture));
  note_command(std::move(words));
}

void ModelCommands::note_map(const FromModelArguments& arguments, const std::string& params) const {
  Words words{"map", "build", "--from-model", path_word(arguments.model), "--machine", path_word(arguments.machine)};
  add_option(words, "--params", params);
  add_option(words, "--zero-missing", arguments.zero_missing);
  add_option(words, "-o", path_word(arguments.output));
  add_option(words, "--params-out", path_word(arguments.params_out));
  note_command(std::move(words));
}

namespace {

/// What was done on the screen to the model as it is now, with the files that it works on.
void record_model(const ModelArguments& files, const model::Model& model, LogRecord done, const char* role) {
  std::vector<std::string> inputs = files.data;
  inputs.push_back(files.machine);
  done.files = seen_files(inputs);
  done.files.push_back({role, files.model, std::make_shared<const std::string>(to_toml(model))});
  record(std::move(done));
}

}  // namespace

void record_saved_model(const ModelArguments& files, const model::Model& model) {
  const std::string last = model.history.empty() ? "" : model.history.back().effect;
  record_model(files, model,
               {.kind = "model",
                .summary = last.empty() ? "MODEL: saved" : "MODEL: saved, the last effect added is " + last,
                .content = one_line(object_of("screen"_is("MODEL"), "model"_is(files.model)))},
               "output");
}

void record_diagnosis(const ModelArguments& files, const model::Model& model, const model::Diagnosis& diagnosis) {
  if (!records_are_kept()) return;
  const Json answer = diagnosis_cell(diagnosis).json;
  const auto headline = answer.find("headline");
  const bool has = headline != answer.end() && headline->is_string();
  record_model(files, model,
               {.kind = "diagnosis",
                .summary = "MODEL: " + (has ? headline->get<std::string>() : "diagnosis"),
                .content = one_line(object_of("screen"_is("MODEL"), "answer"_is(answer)))},
               "input");
}

}  // namespace ecs::commissioning
