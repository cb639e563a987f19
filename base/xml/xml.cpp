#include "base/xml/xml.hpp"

#include <algorithm>

#include <libxml/parser.h>
#include <libxml/xmlerror.h>

#include "base/text.hpp"

namespace ecs {
namespace {

constexpr int kNoNetwork = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_NOCDATA;

std::string string_of(const xmlChar* text) {
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

XmlElement element_of(const xmlNode& node) {
  XmlElement element{string_of(node.name), {}, {}, {}, static_cast<int>(xmlGetLineNo(&node))};
  for (const xmlAttr* one = node.properties; one != nullptr; one = one->next)
    element.attributes.emplace_back(string_of(one->name),
                                    one->children == nullptr ? std::string() : string_of(one->children->content));
  for (const xmlNode* child = node.children; child != nullptr; child = child->next) {
    if (child->type == XML_ELEMENT_NODE) element.children.push_back(element_of(*child));
    if (child->type == XML_TEXT_NODE) element.text += string_of(child->content);
  }
  element.text = std::string(trimmed(element.text));
  return element;
}

}  // namespace

void FreeXml::operator()(_xmlDoc* document) const noexcept { xmlFreeDoc(document); }

Result<XmlDocument> parsed_document(std::string_view xml, const std::string& file) {
  if (xml.size() > kMostXmlBytes)
    return problem_at(file, 0, 0, "an XML document of {} bytes: expected at most {}", xml.size(), kMostXmlBytes);
  xmlInitParser();
  xmlResetLastError();
  XmlDocument document(xmlReadMemory(xml.data(), static_cast<int>(xml.size()), file.c_str(), nullptr, kNoNetwork));
  if (!document) {
    const xmlError* error = xmlGetLastError();
    return problem_at(file, error != nullptr ? error->line : 0, 0, "not XML: {}",
                      error != nullptr && error->message != nullptr ? trimmed(error->message)
                                                                    : std::string_view("it cannot be read"));
  }
  if (document->intSubset != nullptr || document->extSubset != nullptr)
    return problem_at(file, 0, 0, "a document type declaration (<!DOCTYPE) is refused, because it can define entities");
  if (xmlDocGetRootElement(document.get()) == nullptr) return problem_at(file, 0, 0, "not XML: it has no element");
  return document;
}

Result<XmlElement> parsed_xml(std::string_view xml, const std::string& file) {
  ECS_TRY(document, parsed_document(xml, file));
  return element_of(*xmlDocGetRootElement(document.get()));
}

std::string_view attribute_of(const XmlElement& element, std::string_view name) {
  const auto at = std::ranges::find_if(element.attributes, [&](const auto& one) { return one.first == name; });
  return at == element.attributes.end() ? std::string_view() : std::string_view(at->second);
}

const XmlElement* element_below(const XmlElement* element, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (element == nullptr) return nullptr;
    const auto at = std::ranges::find(element->children, name, &XmlElement::name);
    element = at == element->children.end() ? nullptr : &*at;
  }
  return element;
}

std::string all_text_of(const XmlElement& element) {
  std::string text = element.text;
  for (const XmlElement& child : element.children) text += all_text_of(child);
  return text;
}

}  // namespace ecs
