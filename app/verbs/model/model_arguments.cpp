#include "app/verbs/model/model_arguments.hpp"

#include "app/verbs/laser/import_arguments.hpp"

namespace ecs::app {

void take_machine(Verb& verb, std::string& machine) {
  verb.text("--machine", machine, "the machine (.toml): datum, travels, lever arms, pitches");
}

void take_model_and_data(Verb& verb, ModelArguments& arguments, Need data) {
  verb.text("MODEL", arguments.model, "model file (.toml)", Need::required)
      .texts("DATA", arguments.data, "measurement files, any that `laser import` reads", data);
  take_machine(verb, arguments.machine);
  take_import_options(verb, arguments.import);
}

}  // namespace ecs::app
