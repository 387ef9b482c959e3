// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/verdict/diagnose.hpp>

namespace rths::diagnosis {

/// What a case can tell, before any fit.
struct Plan {
  /// A record and its part in the diagnosis.
  struct PlannedRecord {
    std::string name, role;         ///< "unseen proof"
    double duration = 0, rate = 0;  ///< [s], [Hz]; without time rows, and 0
  };
  /// What a diagnosis takes, from the time of the plan itself: of one round of the search, which
  /// suffices if nothing is missing, and of the twenty rounds that several effects may need.
  struct Cost {
    double values = 0;                 ///< compared, of the records that are fitted or scored
    double memory = 0;                 ///< [B]
    double shortest = 0, longest = 0;  ///< of one processor [s]
  };
  /// An effect of typical size in the motion of the records.
  struct Effect {
    std::string name, title, channel;
    Part part = Part::Machine;
    std::string parameter, unit;
    double size = 0;         ///< of `parameter`: typical [unit]
    double information = 0;  ///< of the part that the fitted parameters cannot reproduce [nat]
    /// Size at which the information is kDetectable, by secants; 0: not known [unit].
    double smallest = 0;
  };
  /// An effect that another one can imitate.
  struct Confusion {
    std::string effect, rival;
    double share = 0;  ///< of the effect's visible part that the rival reproduces [-]
    double left = 0;   ///< information that the rival does not reproduce [nat]
  };
  /// One relation between channels.
  struct Examined {
    std::string relation;
    std::vector<std::string> outputs;   ///< roles
    double rate = 0, cutoff = 0;        ///< of the comparison [Hz]; cutoff 0: no filter
    std::vector<std::string> visited;   ///< "displacement: up to 0.1 m and 0.5 m/s"
    std::vector<std::string> fitted;    ///< parameters
    std::vector<Effect> effects;        ///< most visible first
    std::vector<Confusion> confusions;  ///< closest first
    Cost cost;
  };

  std::string case_name, kind;
  std::vector<PlannedRecord> records;
  NoiseBasis noise;
  std::vector<std::string> limits;  ///< channels that are missing or not used
  std::vector<Examined> relations;
};

/// An effect is detectable from this information on; two are distinguishable from that one on
/// [nat].
inline constexpr double kDetectable = 25, kDistinguishable = 12;

/// Checks the records and the model of a case as `diagnose` does before the first fit.
/// @throws Error   @setup
void check_model(const Case& c);

/// Plans the diagnosis of a case: effects that it can find, in the motion and the noise of its
/// records, around the model as stated.
/// @throws Error as `diagnose`   @setup
[[nodiscard]] Plan plan(const Case& c, const DiagnosisOptions& options = {});

}  // namespace rths::diagnosis
