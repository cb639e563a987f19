// What the module brings: a logbook of what is done, verbs and a screen that read it, certificates.
#include "app/cli/module.hpp"

#include "app/ui/screen.hpp"
#include "modules/logbook/recorder.hpp"

namespace ecs::app {

extern const std::vector<Action> kLogReading, kLogExporting, kLogVerification;
/// Round a verb: what it did goes into the logbook.
AroundVerb logged_verb(const std::vector<std::string>& words);
std::unique_ptr<Screen> logbook_screen();

const Module& logbook_module() {
  static const Module module{
      .menus = {{"log", "LOGBOOK: what was done at a machine, each entry tied to the one before"}},
      .verbs = {{"volume", &kLogReading}, {"volume", &kLogExporting}, {"volume", &kLogVerification}},
      .screens = {{"LOGBOOK", "what was done at a machine; verify, replay",
                   [](const auto&) { return logbook_screen(); }}},
      .synonyms = {{"LOGBOOK", "history entries certificate audit traceability who when wear"},
                   {"log compare", "wear worn year drift history"},
                   {"log export", "certificate calibration dcc audit"}},
      .begin = [] { commissioning::keep_logbook(); },
      .around = logged_verb};
  return module;
}

}  // namespace ecs::app
