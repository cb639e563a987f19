// A Digital Calibration Certificate (PTB, DCC 3.3.0 and 3.2.1; units in D-SI) of what was measured at a machine.
// Does not live here: its validation and reading (xml.hpp), what goes into it (certificate.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/logbook/instrument.hpp"

namespace ecs::commissioning {

/// A value with its expanded uncertainty (k = 2).
struct CertifiedValue {
  std::string name;      ///< "bidirectional accuracy of positioning A (ISO 230-2)"
  std::string ref_type;  ///< "iso230_A"
  double value = 0.0;
  std::string unit;  ///< as D-SI writes it: "\micro\metre"
  std::optional<double> expanded;
};

/// Values along an axis.
struct CertifiedCurve {
  std::string name;  ///< "mean error, forward"
  std::string unit;
  std::vector<double> position_mm;  ///< degrees where `position_unit` says so
  std::vector<double> value;
};

struct CertifiedLine {
  std::string name;         ///< "EXX, positioning of X"
  std::string description;  ///< file with its hash, what was taken off, conditions of the standard that are not met
  std::string method;       ///< "statistics of positioning"
  std::string norm;         ///< "ISO 230-2:2014"
  Instrument instrument;    ///< that measured it
  std::string position_unit = "\\milli\\metre";
  std::vector<CertifiedValue> values;
  std::vector<CertifiedCurve> curves;
};

struct PreviousCertificate {
  std::string identifier;
  std::string sha256;  ///< of its file
};

struct Certificate {
  std::string schema_version = "3.3.0";
  std::string identifier;
  std::string country;  ///< ISO 3166-1; empty: not given
  std::string begin_date, end_date, issue_date;
  std::string program;  ///< and its version
  std::string machine, serial_number, manufacturer;
  std::string laboratory, city, customer, person;
  std::string logbook_hash;  ///< of the last entry before this certificate
  std::string active_image;  ///< hash of the image that is active in the unit; empty: none
  std::optional<PreviousCertificate> previous;
  std::vector<CertifiedLine> lines;
  std::vector<std::string> remarks;
  bool to_be_signed = false;  ///< with the empty signature that xmlsec1 fills
};

/// The D-SI spelling of "um" and "um/m"; of another unit as it is.
[[nodiscard]] std::string dsi_unit(std::string_view unit);

/// As XML 1.0 in UTF-8. @pre at least one line
[[nodiscard]] std::string dcc_xml(const Certificate& certificate);

}  // namespace ecs::commissioning
