// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/verdict/verdict.hpp>

namespace rths::report::test_support {

/// Verdicts on a mass on a spring with friction, as a diagnosis might report them. Motions, forces
/// and predictions are computed here and marked as synthetic.
/// A machine with guide friction that the simulation omits.
[[nodiscard]] diagnosis::Verdict missing_verdict();
/// A simulation that omits nothing.
[[nodiscard]] diagnosis::Verdict none_verdict();
/// An unnamed force that depends on displacement.
[[nodiscard]] diagnosis::Verdict unknown_verdict();

/// Two peaks and a spectrum with their intervals.
budget::ResponseBands example_bands();

}  // namespace rths::report::test_support
