// XML that others wrote, read by libxml2: as its document, or as a tree of elements without its types. Does not live
// here: what the elements mean, schemas (modules/logbook).
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"

struct _xmlDoc;  // NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): xmlDoc of libxml2

namespace ecs {

/// A longer document is refused.
inline constexpr std::size_t kMostXmlBytes = std::size_t{16} << 20;

struct FreeXml {
  void operator()(_xmlDoc* document) const noexcept;
};
using XmlDocument = std::unique_ptr<_xmlDoc, FreeXml>;

/// Nothing is fetched. Refused, with its line where there is one: text that is no XML, more than kMostXmlBytes,
/// elements more than 256 deep, a document type declaration (entities that multiply the text need one).
[[nodiscard]] Result<XmlDocument> parsed_document(std::string_view xml, const std::string& file);

struct XmlElement {
  std::string name;                                             ///< without the prefix of its namespace
  std::vector<std::pair<std::string, std::string>> attributes;  ///< names without prefixes
  std::string text;                                             ///< directly in it, without blanks around it
  std::vector<XmlElement> children;
  int line = 0;
};

/// The root. Refused: as by parsed_document().
[[nodiscard]] Result<XmlElement> parsed_xml(std::string_view xml, const std::string& file);

/// Empty: it has none of that name.
[[nodiscard]] std::string_view attribute_of(const XmlElement& element, std::string_view name);

/// The first element below, by the names on the way; null: none, or no element to begin with.
[[nodiscard]] const XmlElement* element_below(const XmlElement* element, std::initializer_list<std::string_view> names);

/// Its own text and that of all below.
[[nodiscard]] std::string all_text_of(const XmlElement& element);

}  // namespace ecs
