#include "base/xml/xml.hpp"

#include <cstdarg>
#include <cstdlib>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/xmlerror.h>
#include <libxml/xmlschemas.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "modules/logbook/certificate.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFaults = 50;

template <auto free>
struct FreeWith {
  template <class T>
  void operator()(T* object) const noexcept {
    free(object);
  }
};

/// Files that a schema may name, by the last part of their names. libxml2 knows one loader for the whole process.
std::vector<fs::path>& catalogue() {
  static thread_local std::vector<fs::path> files;
  return files;
}

/// How many last parts of two paths agree.
std::size_t common_end(const fs::path& a, const fs::path& b) {
  const std::vector<fs::path> x(a.begin(), a.end()), y(b.begin(), b.end());
  std::size_t n = 0;
  while (n < x.size() && n < y.size() && x[x.size() - 1 - n] == y[y.size() - 1 - n]) ++n;
  return n;
}

/// A file of the catalogue in place of an address: the very path, else the one whose end agrees most.
extern "C" xmlParserInputPtr load_local(const char* address, const char*, xmlParserCtxtPtr context) {
  if (address == nullptr) return nullptr;
  const fs::path wanted(address);
  const fs::path* best = nullptr;
  std::size_t agreed = 0;
  for (const fs::path& file : catalogue()) {
    const std::size_t agrees = common_end(wanted.lexically_normal(), file);
    if (agrees > agreed) {
      agreed = agrees;
      best = &file;
    }
  }
  return best == nullptr ? nullptr : xmlNewInputFromFile(context, best->c_str());
}

struct Faults {
  std::string file;
  std::vector<Problem> list;
};

void take_fault(void* into, xmlErrorPtr error) {
  auto& faults = *static_cast<Faults*>(into);
  if (error == nullptr || error->message == nullptr || faults.list.size() >= kMostFaults) return;
  faults.list.push_back({ProblemKind::refused, std::string(trimmed(error->message)), faults.file, error->line, 0, {}});
}

/// The schema's own files instead of the network, while it lives.
class LocalOnly {
 public:
  explicit LocalOnly(const fs::path& folder) : before_(xmlGetExternalEntityLoader()) {
    std::error_code error;
    catalogue().clear();
    for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
      if (at->path().extension() == ".xsd" || at->path().extension() == ".dtd")
        catalogue().push_back(fs::absolute(at->path(), error).lexically_normal());
    xmlSetExternalEntityLoader(load_local);
  }
  LocalOnly(const LocalOnly&) = delete;
  LocalOnly& operator=(const LocalOnly&) = delete;
  ~LocalOnly() {
    xmlSetExternalEntityLoader(before_);
    catalogue().clear();
  }

 private:
  xmlExternalEntityLoader before_;
};

/// The version that a dcc.xsd states; empty: it is none that ECS writes.
std::string version_of(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return {};
  const std::size_t begin = text->find("schema version=\"");
  if (begin == std::string::npos || text->find("https://ptb.de/dcc") == std::string::npos) return {};
  const std::size_t from = begin + 16;
  std::string version = text->substr(from, text->find('"', from) - from);
  return version.starts_with("3.3.") || version.starts_with("3.2.") ? version : std::string();
}

std::string words_below(const XmlElement* element, std::initializer_list<std::string_view> names) {
  const XmlElement* found = element_below(element, names);
  if (found == nullptr) return {};
  const XmlElement* content = element_below(found, {"content"});
  return all_text_of(content != nullptr ? *content : *found);
}

/// The identification that the maker gave; else the first.
std::string serial_number_in(const XmlElement* item) {
  const XmlElement* list = element_below(item, {"identifications"});
  if (list == nullptr) return {};
  std::string first;
  for (const XmlElement& one : list->children) {
    if (one.name != "identification") continue;
    std::string value = words_below(&one, {"value"});
    if (words_below(&one, {"issuer"}) == "manufacturer") return value;
    if (first.empty()) first = std::move(value);
  }
  return first;
}

}  // namespace

std::string schema_folder_or_empty(const std::string& given) {
  const char* set = std::getenv("ECS_DCC_SCHEMA");
  return !given.empty() ? given : set != nullptr ? std::string(set) : std::string();
}

Result<SchemaFolder> schema_in(const fs::path& folder, const std::string& version) {
  SchemaFolder found;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename() != "dcc.xsd") continue;
    std::string of = version_of(at->path());
    if (of.empty() || of <= found.version || (!version.empty() && of != version)) continue;
    found = {folder, at->path(), std::move(of)};
  }
  if (found.version.empty())
    return problem_at(folder.string(), 0, 0,
                      "expected a folder with the dcc.xsd of DCC {} and its imports (https://ptb.de/dcc), found none",
                      version.empty() ? "3.3 or 3.2" : version);
  return found;
}

Result<void> valid_by_schema(std::string_view xml, const SchemaFolder& schema, const std::string& file) {
  ECS_TRY(document, parsed_document(xml, file));
  const LocalOnly local(schema.folder);
  Faults faults{schema.dcc.string(), {}};
  const std::unique_ptr<xmlSchemaParserCtxt, FreeWith<xmlSchemaFreeParserCtxt>> parser(
      xmlSchemaNewParserCtxt(schema.dcc.c_str()));
  xmlSchemaSetParserStructuredErrors(parser.get(), take_fault, &faults);
  const std::unique_ptr<xmlSchema, FreeWith<xmlSchemaFree>> rules(xmlSchemaParse(parser.get()));
  if (!rules || !faults.list.empty()) {
    if (faults.list.empty())
      faults.list.push_back({ProblemKind::bad_input, "the schema cannot be read", faults.file, 0, 0, {}});
    for (Problem& one : faults.list) one.kind = ProblemKind::bad_input;
    return tl::unexpected(folded(std::move(faults.list)));
  }
  faults.file = file;
  const std::unique_ptr<xmlSchemaValidCtxt, FreeWith<xmlSchemaFreeValidCtxt>> check(xmlSchemaNewValidCtxt(rules.get()));
  xmlSchemaSetValidStructuredErrors(check.get(), take_fault, &faults);
  const int result = xmlSchemaValidateDoc(check.get(), document.get());
  if (result == 0 && faults.list.empty()) return {};
  if (faults.list.empty())
    faults.list.push_back(
        {ProblemKind::refused, fmt::format("does not fit the schema (code {})", result), file, 0, 0, {}});
  return tl::unexpected(folded(std::move(faults.list)));
}

Result<Instrument> instrument_in_dcc(std::string_view xml, const std::string& file) {
  ECS_TRY(root, parsed_xml(xml, file));
  if (root.name != "digitalCalibrationCertificate")
    return problem_at(file, 0, 0, "expected a Digital Calibration Certificate, found another XML document");
  const XmlElement* data = element_below(&root, {"administrativeData"});
  const XmlElement* item = element_below(data, {"items", "item"});
  Instrument instrument;
  instrument.name = words_below(item, {"name"});
  instrument.manufacturer = words_below(item, {"manufacturer", "name"});
  instrument.serial_number = serial_number_in(item);
  instrument.calibration_certificate = words_below(data, {"coreData", "uniqueIdentifier"});
  instrument.calibration_date = words_below(data, {"coreData", "endPerformanceDate"});
  if (instrument.name.empty() || instrument.calibration_certificate.empty())
    return problem_at(file, 0, 0, "the certificate names no item, or has no identifier");
  return instrument;
}

}  // namespace ecs::commissioning
