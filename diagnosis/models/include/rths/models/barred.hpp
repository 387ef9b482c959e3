// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// Checks that excluded terms exist: each must be a kind of the catalogue or a name in verdicts.
/// @throws Error for the first unknown name, with the nearest known one   @setup
void reject_unknown_terms(const std::vector<std::string>& without, const Case& c);

/// Returns whether a name or its kind is excluded.
[[nodiscard]] bool is_barred(const std::vector<std::string>& without, const std::string& name,
                             const std::string& kind);

}  // namespace rths::diagnosis
