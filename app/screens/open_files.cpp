#include "app/screens/open_files.hpp"

#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "app/screens/forms/rows.hpp"
#include "app/screens/laser/screen.hpp"
#include "app/screens/memory/screen.hpp"
#include "app/screens/model/form.hpp"
#include "app/screens/parameters/screen.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/session/event_log.hpp"
#include "commissioning/session/recent_files.hpp"

namespace ecs::app {
namespace {

using Files = std::map<FileKind, std::vector<std::string>>;

std::string first_of(const Files& files, FileKind kind) {
  const auto found = files.find(kind);
  return found == files.end() ? std::string() : found->second.front();
}

}  // namespace

std::unique_ptr<Screen> screen_for_files(const std::vector<std::string>& paths,
                                         const std::shared_ptr<UnitConnection>& connection) {
  Files files;
  for (const std::string& path : paths) {
    std::error_code fault;
    const std::string whole = std::filesystem::absolute(path, fault).lexically_normal().string();
    files[looked_at(whole).kind].push_back(whole);
    remember_file(whole);
  }
  const auto has = [&files](FileKind kind) { return files.contains(kind); };
  if (has(FileKind::model)) {
    const auto data = files.find(FileKind::measurements);
    return model_form(connection, {first_of(files, FileKind::model), first_of(files, FileKind::machine),
                                   data == files.end() ? std::vector<std::string>{} : data->second});
  }
  if (has(FileKind::lengths))
    return form_titled("LENGTHS", connection,
                       {{"LENGTHS", first_of(files, FileKind::lengths)},
                        {"--machine", first_of(files, FileKind::machine)},
                        {"--params", first_of(files, FileKind::parameters)}},
                       true);
  if (has(FileKind::measurements) || has(FileKind::map)) {
    auto screen = std::make_unique<LaserScreen>(connection);
    const FileKind kind = has(FileKind::measurements) ? FileKind::measurements : FileKind::map;
    screen->open(files.at(kind), kind);
    return screen;
  }
  for (const FileKind kind : {FileKind::parameters, FileKind::machine})
    if (has(kind)) {
      auto screen = std::make_unique<ParametersScreen>(connection);
      screen->open(first_of(files, kind), kind);
      return screen;
    }
  if (has(FileKind::memory)) {
    auto screen = std::make_unique<MemoryScreen>(connection);
    screen->open(first_of(files, FileKind::memory));
    return screen;
  }
  if (has(FileKind::datum_record)) return datum_view_screen_of(first_of(files, FileKind::datum_record));
  if (has(FileKind::status)) return status_screen(connection, first_of(files, FileKind::status));
  log_event(Tone::bad,
            fmt::format("{}: no screen works with it; laser import --help says what can be read", paths.front()));
  return nullptr;
}

}  // namespace ecs::app
