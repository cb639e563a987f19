#include "app/verbs/model/model_arguments.hpp"

#include "app/verbs/laser/import_arguments.hpp"

namespace ecs::app {

ModelOptions::ModelOptions(Verb& verb, Need data_need) {
  verb.text("MODEL", model, "model file (.toml)", Need::required)
      .texts("DATA", data, "measurement files, any that `laser import` reads, and files of circles and diagonals",
             data_need)
      .text("--machine", machine, kMachineHelp);
  take_import_options(verb, import);
}

}  // namespace ecs::app
