#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text.hpp"
#include "modules/logbook/certificate.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kCoverageFactor = 2.0;
constexpr double kCoverageProbability = 0.95;
constexpr std::string_view kNotStated = "not stated";
constexpr const char* kUnknownCountry = "ZZ";  ///< of ISO 3166-1's codes for users: the schema wants two letters

/// For text and attributes; characters that XML 1.0 has not are left out.
std::string escaped(std::string_view text) {
  static const std::map<char, std::string_view> kNamed{{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text)
    if (const auto named = kNamed.find(c); named != kNamed.end())
      out += named->second;
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t')
      out += c;
  return out;
}

/// Never empty and without blanks at its ends: dcc:notEmptyStringType.
std::string filled(const std::string& text) {
  const std::string_view words = trimmed(text);
  return escaped(words.empty() ? kNotStated : words);
}

/// Elements, one inside the other.
class Xml {
 public:
  Xml& open(const std::string& name, const std::string& attributes = {}) {
    text_ += fmt::format("{:>{}}<{}{}{}>\n", "", 2 * names_.size(), name, attributes.empty() ? "" : " ", attributes);
    names_.push_back(name);
    return *this;
  }
  Xml& close() {
    const std::string name = std::move(names_.back());
    names_.pop_back();
    text_ += fmt::format("{:>{}}</{}>\n", "", 2 * names_.size(), name);
    return *this;
  }
  /// @param value  escaped
  Xml& leaf(const std::string& name, const std::string& value) {
    text_ += fmt::format("{:>{}}<{}>{}</{}>\n", "", 2 * names_.size(), name, value, name);
    return *this;
  }
  /// dcc:textType and dcc:richContentType.
  Xml& words(const std::string& name, const std::string& value) {
    open(name);
    text_ += fmt::format("{:>{}}<dcc:content lang=\"en\">{}</dcc:content>\n", "", 2 * names_.size(), filled(value));
    return close();
  }
  Xml& raw(const std::string& text) {
    text_ += text;
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  std::vector<std::string> names_;
};

void add_identification(Xml& xml, const char* issuer, const std::string& name, const std::string& value) {
  xml.open("dcc:identification")
      .leaf("dcc:issuer", issuer)
      .leaf("dcc:value", filled(value))
      .words("dcc:name", name)
      .close();
}

void add_hash(Xml& xml, const char* element, const std::string& referral, const std::string& id,
              const std::string& sha256) {
  xml.open(element)
      .words("dcc:referral", referral)
      .leaf("dcc:referralID", filled(id))
      .leaf("dcc:procedure", "SHA-256")
      .leaf("dcc:value", filled(sha256))
      .close();
}

void add_core(Xml& xml, const Certificate& c) {
  xml.open("dcc:coreData")
      .leaf("dcc:countryCodeISO3166_1", c.country.empty() ? kUnknownCountry : filled(c.country))
      .leaf("dcc:usedLangCodeISO639_1", "en")
      .leaf("dcc:mandatoryLangCodeISO639_1", "en")
      .leaf("dcc:uniqueIdentifier", filled(c.identifier));
  xml.open("dcc:identifications");
  add_identification(xml, "calibrationLaboratory", "last hash of the logbook (SHA-256)", c.logbook_hash);
  if (!c.active_image.empty())
    add_identification(xml, "calibrationLaboratory", "hash of the compensation that is active (SHA-256)",
                       c.active_image);
  xml.close();
  xml.leaf("dcc:beginPerformanceDate", c.begin_date)
      .leaf("dcc:endPerformanceDate", c.end_date)
      .leaf("dcc:performanceLocation", c.customer.empty() ? "other" : "customer")
      .leaf("dcc:issueDate", c.issue_date);
  if (c.previous)
    add_hash(xml, "dcc:previousReport", "previous certificate of this machine", c.previous->identifier,
             c.previous->sha256);
  xml.close();
}

void add_contact(Xml& xml, const std::string& name, const std::string& city, const std::string& country) {
  xml.words("dcc:name", name).open("dcc:location");
  if (!city.empty()) xml.leaf("dcc:city", filled(city));
  if (!country.empty()) xml.leaf("dcc:countryCode", filled(country));
  if (city.empty() && country.empty()) xml.words("dcc:further", {});
  xml.close();
}

void add_administration(Xml& xml, const Certificate& c) {
  xml.open("dcc:administrativeData");
  xml.open("dcc:dccSoftware")
      .open("dcc:software")
      .words("dcc:name", "ECS")
      .leaf("dcc:release", filled(c.program))
      .close()
      .close();
  add_core(xml, c);
  xml.open("dcc:items").open("dcc:item").words("dcc:name", c.machine);
  if (!c.manufacturer.empty()) xml.open("dcc:manufacturer").words("dcc:name", c.manufacturer).close();
  xml.open("dcc:identifications");
  add_identification(xml, "manufacturer", "serial number", c.serial_number);
  xml.close().close().close();
  xml.open("dcc:calibrationLaboratory").open("dcc:contact");
  add_contact(xml, c.laboratory, c.city, c.country);
  xml.close().close();
  xml.open("dcc:respPersons").open("dcc:respPerson").open("dcc:person").words("dcc:name", c.person).close();
  xml.leaf("dcc:mainSigner", "true").close().close();
  xml.open("dcc:customer");
  add_contact(xml, c.customer, {}, {});
  xml.close();
  if (!c.remarks.empty()) {
    xml.open("dcc:statements");
    for (const std::string& remark : c.remarks) xml.open("dcc:statement").words("dcc:declaration", remark).close();
    xml.close();
  }
  xml.close();
}

/// Without the last digits of a double, in which the arithmetic rounds: "-10.7", not "-10.700000000000001".
std::string certified(double value) {
  constexpr double kSteps = 1e9;  // to a billionth of the unit
  return fmt::format("{:.12g}", std::round(value * kSteps) / kSteps + 0.0);
}

/// D-SI 2.1 of DCC 3.2 has expandedUnc; in D-SI 2.2 that is deprecated for measurementUncertaintyUnivariate.
void add_uncertainty(Xml& xml, double expanded, bool before_3_3) {
  if (before_3_3) {
    xml.open("si:expandedUnc").leaf("si:uncertainty", certified(expanded));
  } else {
    xml.open("si:measurementUncertaintyUnivariate")
        .open("si:expandedMU")
        .leaf("si:valueExpandedMU", certified(expanded));
  }
  xml.leaf("si:coverageFactor", shortest(kCoverageFactor))
      .leaf("si:coverageProbability", shortest(kCoverageProbability));
  xml.leaf("si:distribution", "normal").close();
  if (!before_3_3) xml.close();
}

void add_value(Xml& xml, const CertifiedValue& one, bool before_3_3) {
  xml.open("dcc:result", fmt::format("refType=\"{}\"", escaped(one.ref_type))).words("dcc:name", one.name);
  xml.open("dcc:data").open("dcc:quantity").open("si:real");
  xml.leaf("si:value", certified(one.value)).leaf("si:unit", escaped(one.unit));
  if (one.expanded && *one.expanded > 0.0) add_uncertainty(xml, *one.expanded, before_3_3);
  xml.close().close().close().close();
}

std::string list_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + certified(value);
  return text;
}

void add_list(Xml& xml, const std::string& name, const std::vector<double>& values, const std::string& unit) {
  xml.open("dcc:quantity").words("dcc:name", name).open("si:realListXMLList");
  xml.leaf("si:valueXMLList", list_of(values)).leaf("si:unitXMLList", escaped(unit)).close().close();
}

void add_curve(Xml& xml, const CertifiedCurve& curve, const std::string& position_unit) {
  xml.open("dcc:result").words("dcc:name", curve.name).open("dcc:data").open("dcc:list");
  add_list(xml, "target position", curve.position_mm, position_unit);
  add_list(xml, curve.name, curve.value, curve.unit);
  xml.close().close().close();
}

void add_equipment(Xml& xml, const Instrument& instrument) {
  if (!is_known(instrument)) return;
  xml.open("dcc:measuringEquipments").open("dcc:measuringEquipment").words("dcc:name", instrument.name);
  std::string calibration;
  const auto add = [&](const char* what, const std::string& value) {
    if (!value.empty()) calibration += fmt::format("{}{} {}", calibration.empty() ? "" : ", ", what, value);
  };
  add("calibration certificate", instrument.calibration_certificate);
  add("calibrated", instrument.calibration_date);
  add("valid until", valid_until(instrument));
  if (!calibration.empty()) xml.words("dcc:description", calibration);
  if (!instrument.manufacturer.empty()) xml.open("dcc:manufacturer").words("dcc:name", instrument.manufacturer).close();
  xml.open("dcc:identifications");
  add_identification(xml, "manufacturer", "serial number", instrument.serial_number);
  if (!instrument.calibration_certificate.empty())
    add_identification(xml, "calibrationLaboratory", "calibration certificate", instrument.calibration_certificate);
  xml.close().close().close();
}

void add_results(Xml& xml, const Certificate& c) {
  const bool before_3_3 = c.schema_version.starts_with("3.2");
  xml.open("dcc:measurementResults");
  for (const CertifiedLine& line : c.lines) {
    xml.open("dcc:measurementResult").words("dcc:name", line.name).words("dcc:description", line.description);
    xml.open("dcc:usedMethods").open("dcc:usedMethod").words("dcc:name", line.method);
    xml.leaf("dcc:norm", filled(line.norm)).close().close();
    add_equipment(xml, line.instrument);
    xml.open("dcc:results");
    for (const CertifiedValue& value : line.values) add_value(xml, value, before_3_3);
    for (const CertifiedCurve& curve : line.curves) add_curve(xml, curve, line.position_unit);
    xml.close().close();
  }
  xml.close();
}

/// Over the whole document without itself: RSA with SHA-256, the certificate of the key beside it.
constexpr const char* kSignature =
    "  <ds:Signature>\n"
    "    <ds:SignedInfo>\n"
    "      <ds:CanonicalizationMethod Algorithm=\"http://www.w3.org/2001/10/xml-exc-c14n#\"/>\n"
    "      <ds:SignatureMethod Algorithm=\"http://www.w3.org/2001/04/xmldsig-more#rsa-sha256\"/>\n"
    "      <ds:Reference URI=\"\">\n"
    "        <ds:Transforms>\n"
    "          <ds:Transform Algorithm=\"http://www.w3.org/2000/09/xmldsig#enveloped-signature\"/>\n"
    "        </ds:Transforms>\n"
    "        <ds:DigestMethod Algorithm=\"http://www.w3.org/2001/04/xmlenc#sha256\"/>\n"
    "        <ds:DigestValue/>\n"
    "      </ds:Reference>\n"
    "    </ds:SignedInfo>\n"
    "    <ds:SignatureValue/>\n"
    "    <ds:KeyInfo><ds:X509Data/></ds:KeyInfo>\n"
    "  </ds:Signature>\n";

}  // namespace

std::string dsi_unit(std::string_view unit) {
  if (unit == "um") return "\\micro\\metre";
  if (unit == "um/m") return "\\micro\\metre\\metre\\tothe{-1}";
  if (unit == "mm") return "\\milli\\metre";
  if (unit == "deg") return "\\degree";
  return std::string(unit);
}

std::string dcc_xml(const Certificate& certificate) {
  Xml xml;
  xml.open("dcc:digitalCalibrationCertificate",
           fmt::format("xmlns:dcc=\"https://ptb.de/dcc\" xmlns:si=\"https://ptb.de/si\" "
                       "xmlns:ds=\"http://www.w3.org/2000/09/xmldsig#\" schemaVersion=\"{}\"",
                       certificate.schema_version));
  add_administration(xml, certificate);
  add_results(xml, certificate);
  if (certificate.to_be_signed) xml.raw(kSignature);
  xml.close();
  return xml.take();
}

}  // namespace ecs::commissioning
