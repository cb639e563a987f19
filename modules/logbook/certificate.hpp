// A Digital Calibration Certificate (PTB, DCC 3.3.0 and 3.2.1; units in D-SI) of what was measured at a machine:
// gathered from a logbook (gather.cpp), written (dcc.cpp), checked against the published schema and read (xml.cpp;
// nothing is fetched: schemas come from a folder on this computer).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/replay.hpp"

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

/// What the logbook does not know.
struct CertificateWishes {
  std::string laboratory, city, customer, person;
  std::string country;  ///< of the laboratory, ISO 3166-1
  std::string schema_version = "3.3.0";
  std::vector<std::string> uncertainty;  ///< words of `laser stats`: "--instrument-um-per-m", "0.5"
  bool all = false;                      ///< every measurement, not only those since the last certificate
  bool to_be_signed = false;
};

/// @param now  "2026-05-04T09:30:00Z"  `refused` where nothing measured can be certified, with the reasons.
[[nodiscard]] Result<Certificate> certificate_of(const Logbook& book, const CertificateWishes& wishes,
                                                 const RunVerb& run, const std::string& now);

/// The certificate with its signature, by the program xmlsec1. @param key, signer  PEM files; signer may be empty
[[nodiscard]] Result<std::string> signed_by(const std::string& xml, const std::string& key, const std::string& signer);

/// A folder, with folders in it, that holds dcc.xsd and what it imports (SI_Format.xsd, the signature's schema).
struct SchemaFolder {
  std::filesystem::path folder;
  std::filesystem::path dcc;  ///< the dcc.xsd of the newest version that ECS writes
  std::string version;        ///< "3.3.0", "3.2.1"
};
/// Versions 3.3 and 3.2, the newest first. @param version  only this one; empty: any
[[nodiscard]] Result<SchemaFolder> schema_in(const std::filesystem::path& folder, const std::string& version = {});
/// --schema as given, else $ECS_DCC_SCHEMA; empty: neither.
[[nodiscard]] std::string schema_folder_or_empty(const std::string& given);

/// A `refused` problem with every fault that libxml2 finds, at its line. @param file  name in problems
[[nodiscard]] Result<void> valid_by_schema(std::string_view xml, const SchemaFolder& schema, const std::string& file);

/// What a calibration certificate says of its item: name, maker, serial number, identifier, date. Of DCC 2.4 and later.
[[nodiscard]] Result<Instrument> instrument_in_dcc(std::string_view xml, const std::string& file);

}  // namespace ecs::commissioning
