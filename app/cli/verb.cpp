#include "app/cli/verb.hpp"

namespace ecs::app {

VerbDefinition verb(std::string path, std::string help, std::string example, void (*declare)(Verb&),
                    Result<Outcome> (*run)(VerbContext&)) {
  return {std::move(path), std::move(help), std::move(example), [declare, run](Verb& options) -> Action {
            declare(options);
            return run;
          }};
}

}  // namespace ecs::app
