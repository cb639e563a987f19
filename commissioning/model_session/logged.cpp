#include "commissioning/model_session/logged.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/json.hpp"
#include "commissioning/logbook/observed.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/models/diagnosis_view.hpp"

namespace ecs::commissioning {

void log_saved_model(const ModelArguments& files, const model::Model& model) {
  if (!logbook_is_kept()) return;
  std::vector<std::string> inputs = files.data;
  inputs.push_back(files.machine);
  const std::string last = model.history.empty() ? "" : model.history.back().effect;
  LogRecord made;
  made.kind = "model";
  made.summary = last.empty() ? "MODEL: saved" : fmt::format("MODEL: saved, the last effect added is {}", last);
  made.content = one_line(Json{{"screen", "MODEL"}, {"model", files.model}});
  made.files = seen_files("input", inputs);
  made.files.push_back({"output", files.model, std::make_shared<const std::string>(to_toml(model))});
  record(std::move(made));
}

void log_diagnosis(const ModelArguments& files, const model::Model& model, const model::Diagnosis& diagnosis) {
  if (!logbook_is_kept()) return;
  const Json answer = diagnosis_cell(diagnosis).json;
  std::vector<std::string> inputs = files.data;
  inputs.push_back(files.machine);
  LogRecord made;
  made.kind = "diagnosis";
  made.summary =
      "MODEL: " + (answer.contains("headline") && answer["headline"].is_string() ? answer["headline"].get<std::string>()
                                                                                 : std::string("diagnosis"));
  made.content = one_line(Json{{"screen", "MODEL"}, {"answer", answer}});
  made.files = seen_files("input", inputs);
  made.files.push_back({"input", files.model, std::make_shared<const std::string>(to_toml(model))});
  record(std::move(made));
}

}  // namespace ecs::commissioning
