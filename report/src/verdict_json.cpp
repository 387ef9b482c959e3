// SPDX-License-Identifier: Apache-2.0
#include "numbers.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <rths/maths/statistics.hpp>
#include <rths/report/diagnosis.hpp>

#include "instants.hpp"

namespace rths::report {
namespace {

using diagnosis::Cause;
using diagnosis::is_guess;
using diagnosis::Verdict;

// JSON cannot represent NaN and infinity: they become null.
Json number(double value, int digits = kDigits) {
  if (!std::isfinite(value)) return nullptr;
  return value == 0 ? 0.0 : maths::rounded(value, digits);
}

Json numbers(const std::vector<double>& values, int digits = kDigits) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value, digits));
  return list;
}

// A hundredth of the distance between instants is visible.
int digits_of_times(double from, double to) {
  constexpr double kShare = 0.01;
  return digits_of_instants(to, kShare * (to - from), kDigits);
}

Json time_interval(const std::pair<double, double>& pair) {
  const int digits = digits_of_times(pair.first, pair.second);
  return Json::array({number(pair.first, digits), number(pair.second, digits)});
}

Json interval(const std::pair<double, double>& pair) {
  return Json::array({number(pair.first), number(pair.second)});
}

Json state_json(const diagnosis::StateCell& cell) {
  return {{"displacement_m", interval(cell.displacement)},
          {"velocity_m_per_s", interval(cell.velocity)},
          {"share", number(cell.share)}};
}

Json profile_json(const diagnosis::Profile& profile) {
  const bool is_time = profile.name == "time" && profile.edges.size() > 1;
  const int digits =
      is_time ? digits_of_times(profile.edges.rbegin()[1], profile.edges.back()) : kDigits;
  return {{"name", profile.name},
          {"unit", profile.unit},
          {"edges", numbers(profile.edges, digits)},
          {"share", numbers(profile.share)}};
}

Json where_json(const diagnosis::Where& where) {
  return {{"part", name_of(where.part)},
          {"channel", where.channel},
          {"record", where.record},
          {"of", where.is_of_named ? "named terms" : "residual"},
          {"intervals_s", where.has_time ? each(where.intervals, time_interval) : Json::array()},
          {"intervals_rows", where.has_time ? Json::array() : each(where.intervals, time_interval)},
          {"band_Hz", each(where.bands, interval)},
          {"state", each(where.states, state_json)},
          {"state_map", each(where.state_map, state_json)},
          {"profiles", each(where.profiles, profile_json)}};
}

Json alternative_json(const diagnosis::Alternative& alternative) {
  return {{"name", alternative.name},
          {"title", alternative.title},
          {"share", number(alternative.share)},
          {"test", text_or_null(alternative.test)},
          {"sigma", number(alternative.sigma)}};
}

Json cause_json(const diagnosis::Cause& cause) {
  Json parameters = Json::object();
  for (const auto& p : cause.parameters)
    parameters[p.name] = {{"value", number(p.value)},
                          {"ci95", interval({p.low, p.high})},
                          {"unit", p.unit},
                          {"absent", p.absent ? number(*p.absent) : Json(nullptr)}};
  return {{"name", cause.name},
          {"title", cause.title},
          {"equation", cause.equation},
          {"part", name_of(cause.part)},
          {"is_rule", cause.is_rule},
          {"channel", cause.channel},
          {"confidence", number(cause.confidence)},
          {"explained_fraction", number(cause.explained)},
          {"gain_nat", number(cause.support.gain)},
          {"lead", number(cause.support.lead)},
          {"best_share", number(cause.support.best)},
          {"parameters", parameters},
          {"alternatives", each(cause.alternatives, alternative_json)}};
}

Json score_json(const diagnosis::RecordScore& score) {
  return {{"use", score.use},
          {"nrmse_before", number(score.nrmse_before)},
          {"nrmse_after", number(score.nrmse_after)},
          {"nrmse_stated", number(score.nrmse_stated)},
          {"noise_floor", number(score.noise_floor)},
          {"variance_before", number(score.variance_before)},
          {"variance_after", number(score.variance_after)}};
}

Json proof_json(const diagnosis::ProofSummary& proof) {
  return {{"nrmse_before", number(proof.before)},
          {"nrmse_after", number(proof.after)},
          {"noise_floor", number(proof.floor)},
          {"explained_fraction", number(proof.explained)},
          {"times_noise", number(proof.after / proof.floor)},
          {"systematic", proof.is_systematic},
          {"noise_at_rest", proof.has_noise_at_rest},
          {"noise_known", proof.is_noise_known}};
}

Json relation_json(const diagnosis::RelationVerdict& relation) {
  return {{"name", relation.name},
          {"outputs", relation.outputs},
          {"verdict", name_of(relation.outcome)},
          {"remainder", relation.has_remainder},
          {"causes", relation.causes},
          {"common_law", text_or_null(relation.common_law)},
          {"held_out", relation.is_held_out},
          {"left_nat", number(relation.left)},
          {"proof", proof_json(relation.proof)}};
}

Json refitted_json(const diagnosis::Refitted& parameter) {
  return {{"unit", parameter.unit},
          {"stated", number(parameter.stated)},
          {"before", number(parameter.before)},
          {"after", number(parameter.after)}};
}

Json ablation_json(const diagnosis::Ablation& ablation) {
  return {{"what", ablation.what}, {"nrmse", number(ablation.nrmse)}};
}

Json description_json(const diagnosis::Description& description) {
  return {{"form", description.form},
          {"share", number(description.share)},
          {"of_terms", description.is_of_terms},
          {"x_label", description.x_label},
          {"x", numbers(description.x)},
          {"y", numbers(description.y)},
          {"band", numbers(description.band)}};
}

Json evidence_json(const diagnosis::CandidateEvidence& evidence) {
  return {{"name", evidence.name},
          {"title", evidence.title},
          {"gain_nat", number(evidence.gain)},
          {"ci90", interval({evidence.low, evidence.high})}};
}

Json transfer_json(const sim::AxisTransfer& transfer) {
  Json parameters = Json::object();
  for (const auto& p : transfer.parameters)
    parameters[p.name] = {{"value", number(p.value)},
                          {"ci95", interval({p.value - p.half_width, p.value + p.half_width})},
                          {"unit", p.unit}};
  return {{"delay_s", number(transfer.delay())},
          {"nrms", number(transfer.error)},
          {"nrms_without", number(transfer.error_without)},
          {"residual_m", number(transfer.residual)},
          {"parameters", parameters}};
}

Json axis_budget_json(const budget::AxisBudget& axis) {
  Json shares = Json::object();
  for (unsigned i = 0; i < budget::kParts; ++i)
    shares[name_of(static_cast<budget::Part>(i))] = number(axis.share[i]);
  return {{"axis", name_of(axis.axis)},
          {"difference_before", number(axis.before)},
          {"difference_after", number(axis.after)},
          {"shares", shares},
          {"remainder", number(axis.remainder)},
          {"tracking_nrms", number(axis.tracking)},
          {"held_out_nrms", number(axis.held_out)},
          {"transfer_system", transfer_json(axis.transfer)}};
}

Json budget_json(const budget::MismatchBudget& found) {
  if (found.is_empty()) return nullptr;
  return {{"axes", each(found.axes, axis_budget_json)},
          {"replay_nrms", number(found.replay)},
          {"loops", found.loops},
          {"share_error", number(found.share_error)}};
}

Json peak_json(const budget::PeakBand& peak) {
  return {{"name", peak.name},
          {"unit", peak.unit},
          {"value", number(peak.value)},
          {"ci95", interval({peak.low, peak.high})}};
}

Json spectrum_json(const budget::SpectrumBand& spectrum) {
  return {{"floor", spectrum.floor},
          {"acceleration_m_per_s2", numbers(spectrum.value)},
          {"low", numbers(spectrum.low)},
          {"high", numbers(spectrum.high)}};
}

Json bands_json(const budget::ResponseBands& bands) {
  if (bands.is_empty()) return nullptr;
  return {{"peaks", each(bands.peaks, peak_json)},
          {"frequency_Hz", numbers(bands.frequencies)},
          {"damping_ratio", number(bands.damping_ratio)},
          {"spectra", each(bands.spectra, spectrum_json)},
          {"runs", bands.runs},
          {"remainder_counted", bands.has_remainder}};
}

// The fragment for experiments; of models that are not made of terms, [model] of the improved case.
std::string improved_text(const Verdict& verdict) {
  if (!verdict.improvement.fragment.empty() || !verdict.improvement.source.file.has("model"))
    return verdict.improvement.fragment;
  Config file;
  file.set("model", verdict.improvement.source.file.table("model"));
  return file.to_toml();
}

}  // namespace

Json verdict_numbers(const Verdict& verdict) {
  Json json;
  json["format"] = kVerdictFormat;
  json["case"] = verdict.case_name;
  json["synthetic"] = verdict.synthetic;
  json["verdict"] = name_of(verdict.conclusion.outcome);
  const auto answers = diagnosis::answers_of(verdict);
  json["headline"] = answers.headline;
  json["answers"] = {
      {"missing", answers.missing}, {"certainty", answers.certainty}, {"next", answers.next}};
  json["sentence"] = verdict.sentence;
  json["specimen"] = text_or_null(verdict.specimen);
  json["confidence"] = number(verdict.conclusion.confidence);
  json["remainder"] = verdict.conclusion.has_remainder;
  json["where"] = where_json(verdict.conclusion.where);
  json["budget"] = budget_json(verdict.budget);
  json["improved_response"] = bands_json(verdict.bands);
  std::vector<Cause> causes = verdict.conclusion.causes, guesses;
  std::copy_if(causes.begin(), causes.end(), std::back_inserter(guesses), is_guess);
  std::erase_if(causes, is_guess);
  json["causes"] = each(causes, cause_json);
  json["guesses"] = each(guesses, cause_json);
  json["relations"] = each(verdict.relations, relation_json);
  json["fit"] = Json::object();
  for (const auto& score : verdict.evaluation.fit) json["fit"][score.record] = score_json(score);
  json["refitted"] = Json::object();
  for (const auto& parameter : verdict.evaluation.refitted)
    json["refitted"][parameter.name] = refitted_json(parameter);
  json["proof_record"] = text_or_null(verdict.evaluation.proof_record);
  json["ablation"] = each(verdict.ablation, ablation_json);
  json["proof"] = proof_json(verdict.evaluation.proof);
  json["residual_white"] = verdict.evaluation.residual.is_white;
  json["residual_correlation"] = numbers(verdict.evaluation.residual.correlation);
  json["correlation_bound"] = verdict.evaluation.residual.bound > 0
                                  ? number(verdict.evaluation.residual.bound)
                                  : Json(nullptr);
  json["descriptions"] = each(verdict.descriptions, description_json);
  json["evidence"] = each(verdict.evidence, evidence_json);
  json["limits"] = verdict.limits;
  json["assumed"] = verdict.terms.assumed;
  json["searched"] = verdict.terms.searched;
  json["next_test"] = text_or_null(verdict.next.text);
  json["noise_model"] = verdict.noise.source;
  json["noise_remedy"] = text_or_null(verdict.noise.remedy);
  json["improved_model"] = text_or_null(improved_text(verdict));
  json["seconds"] = number(verdict.seconds);
  return json;
}

std::string verdict_json(const Verdict& verdict) {
  // Names of files may not be UTF-8.
  return verdict_numbers(verdict).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rths::report
