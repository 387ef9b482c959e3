# SPDX-License-Identifier: Apache-2.0
"""Compares one verdict with one answer, by the definitions in docs/diagnosis_trials.md.

Names are compared in the generator's spelling. Only the outcome "missing" can name an effect: causes in
a verdict "unknown" count as reported names, never as the right one. Of tier "raw" more is missing than the
effect, so there "unknown besides the effect" names it. What the tool names in the control of such a case, the same
recording without the effect, is of the recording; the score beside it leaves these names out.
"""
import places
import sizes
from confidence import features_of
from names import canonical, is_form, terms_of

NO_VERDICT = {"verdict": "failed", "where": {}, "causes": [], "fit": {}}
SAME_SIZE = 2  # at most, between the sizes of a cause with and without the effect
FIT_RECORD = "fit"  # of the generator's places
UNSEEN_RECORD = "unseen"  # of its noise floors


def record_of(fit, name):
    """Scores of a record; its name may have the file's extension."""
    return next((row for record, row in fit.items() if record.split(".")[0] == name), None)


def has_remainder(verdict):
    return bool(verdict.get("remainder"))


def first_cause(verdict):
    return verdict["causes"][0] if verdict["causes"] else None


def names_of_tie(cause):
    """A cause and its alternatives, in the generator's names."""
    return [canonical(cause["name"])] + [canonical(row["name"]) for row in cause["alternatives"]]


def has_wrong_rule(answer):
    """Whether specimen and simulation have different rules of hysteresis, as in tier E."""
    specimen = answer.get("specimen", {})
    return any(specimen[key]["value"] != specimen[key]["absent"]
               for key in ("beta", "share_of_second_loop") if key in specimen)


def without_rules(verdict):
    """The verdict without its causes for a wrong rule of hysteresis."""
    causes = [cause for cause in verdict["causes"] if not cause.get("is_rule")]
    is_all = verdict["verdict"] == "missing" and not causes and not has_remainder(verdict)
    return {**verdict, "causes": causes, "verdict": "none" if is_all else verdict["verdict"]}


def right_names(effects):
    """Names that count as right: the effects, other names of them and the terms that describe them."""
    names = {effect["name"] for effect in effects} | {name for effect in effects for name in effect.get("also", [])}
    names |= {effect["term_that_describes_it"] for effect in effects if "term_that_describes_it" in effect}
    return {canonical(name) for name in names}


def _is_right(cause, effects):
    """Whether a cause is one of the effects, in its component if the answer states one."""
    return any(canonical(cause["name"]) in right_names([effect])
               and effect.get("component") in (None, cause.get("channel"), *_components(cause)) for effect in effects)


def _components(cause):
    """Components in the names of a cause's parameters: spring.1.cubic_stiffness.stiffness."""
    return {name.split(f".{cause['name']}.")[0] for name in cause["parameters"]}


def spurious_names(verdict, effects):
    """Names of absent effects. In an indistinguishable case, a tie with the effect does not count."""
    right = right_names(effects)
    may_tie = any(not effect["truth"]["distinguishable"] for effect in effects)
    return [cause["name"] for cause in verdict["causes"]
            if not _is_right(cause, effects)
            and not (may_tie and right & set(names_of_tie(cause)))]


def is_right_first(verdict, effects):
    cause = first_cause(verdict)
    return verdict["verdict"] == "missing" and cause is not None and _is_right(cause, effects)


def is_right_in_tie(verdict, effects):
    """The effect is named, alone or in a tie; if it is not distinguishable, only a tie counts."""
    cause = first_cause(verdict)
    if verdict["verdict"] != "missing" or cause is None:
        return False
    tie = names_of_tie(cause)
    is_tie_reported = len(tie) > 1 or all(effect["truth"]["distinguishable"] for effect in effects)
    return is_tie_reported and bool(right_names(effects) & set(tie))


def _is_named(verdict, effect):
    """Whether a cause is the effect, or is tied with it where it is not distinguishable."""
    is_clear = effect["truth"]["distinguishable"]
    return any(_is_right(cause, [effect]) or not is_clear and right_names([effect]) & set(names_of_tie(cause))
               for cause in verdict["causes"])


def are_all_named(verdict, effects):
    return verdict["verdict"] == "missing" and all(_is_named(verdict, effect) for effect in effects)


def is_abstention(verdict, effects):
    """For an effect outside the library: unknown, a remainder, or a term that describes it."""
    if verdict["verdict"] == "unknown" or (verdict["verdict"] == "missing" and has_remainder(verdict)):
        return True
    return is_right_first(verdict, effects)


def has_right_form(verdict, effect):
    if is_right_first(verdict, [effect]):
        return True
    forms = verdict.get("descriptions", [])
    return bool(forms) and is_form(forms[0]["form"], effect["form"], effect.get("component"))


def _channel(role):
    return (role or "").split(".")[0]


def _place_rows(verdict, answer, effect):
    """Overlap of the verdict's place with e⊥, and with e."""
    where = dict(verdict["where"])
    if where.get("record", FIT_RECORD).split(".")[0] != FIT_RECORD:
        where["intervals_s"] = []  # times of another record do not compare
    if where.get("intervals_rows"):  # a row of the answer counts as a second
        where["intervals_s"] = [[first - 1, last] for first, last in where["intervals_rows"]]
    truth = effect["truth"]
    rest, cells = truth["place_after_nuisances"], answer["cells"]
    return {"iou": places.compare(where, rest, cells),
            "iou_energy": places.compare(where, rest, cells, True) if "time_share" in rest else None,
            "iou_effect": places.compare(where, truth["place"], answer["cells"])}


def _record_rows(verdict, answer):
    unseen = record_of(verdict["fit"], UNSEEN_RECORD) or {}
    floors = answer.get("nrmse_on_unseen", {})
    row = {"nrmse_before": unseen.get("nrmse_before"), "nrmse_after": unseen.get("nrmse_after"),
           "noise_floor": unseen.get("noise_floor"), "oracle": floors.get("oracle"),
           "variance_after": unseen.get("variance_after"),
           "white": verdict.get("residual_white")}
    if row["nrmse_after"] is not None and row["oracle"]:
        row["after_to_oracle"] = row["nrmse_after"] / row["oracle"]
    return row


def _effect_row(verdict, answer, effect):
    """The row's entries for a case with one effect."""
    where = verdict["where"]
    row = {"part_right": where.get("part") == effect["part"],
           "channel_right": _channel(where.get("channel")) == effect["channel"],
           "part_truth": effect["part"], "channel_truth": effect["channel"],
           "sizes": []}
    row.update(_place_rows(verdict, answer, effect))
    cause = first_cause(verdict)
    if cause is not None and _is_right(cause, [effect]) and canonical(cause["name"]) != effect.get("term_that_describes_it"):
        row["sizes"] = sizes.compare(effect, answer, cause)
    return row


def names_of(verdict, effects):
    """Each name and guess with its confidence, what speaks for it, and whether it is right."""
    relation = {name: one for one in verdict.get("relations", []) for name in one["causes"]}
    return [{"name": cause["name"], "confidence": cause["confidence"], "right": _is_right(cause, effects),
             "features": features_of(cause, relation.get(cause["name"]))}
            for cause in terms_of(verdict) if cause.get("confidence") is not None]


def naming(verdict, answer):
    """The verdict that may name effects: of tier "raw" also one that names causes beside an unknown remainder."""
    is_beside = answer.get("tier") == "raw" and verdict["verdict"] == "unknown" and bool(verdict["causes"])
    return {**verdict, "verdict": "missing", "remainder": True} if is_beside else verdict


def _sizes(one, other):
    """Values of the first parameter that neither of two causes has at zero: sizes come first."""
    for name, row in one["parameters"].items():
        a, b = row["value"], other["parameters"].get(name, {}).get("value")
        if a and b:
            return a, b
    return 1, 1


def _is_same_cause(one, other):
    """Whether two verdicts name the same cause at a similar size."""
    a, b = _sizes(one, other)
    return (canonical(one["name"]) == canonical(other["name"]) and one.get("channel") == other.get("channel")
            and a * b > 0 and max(a / b, b / a) < SAME_SIZE)


def beside_recording(verdict, control):
    """The verdict without the causes that the tool also names in the control."""
    of_recording = terms_of(control)
    return {**verdict, **{key: [cause for cause in verdict.get(key, [])
                                if not any(_is_same_cause(cause, other) for other in of_recording)] for key in ("causes", "guesses")}}


def _beside_rows(verdict, answer, control):
    """The score without what is of the recording."""
    effects, left = answer["effects"], beside_recording(verdict, control)
    named = naming(left, answer)
    kept = {id(cause) for cause in left["causes"]}
    return {"of_recording": [cause["name"] for cause in verdict["causes"] if id(cause) not in kept],
            "right_first_beside": is_right_first(named, effects), "all_named_beside": are_all_named(named, effects),
            "spurious_beside": spurious_names(left, effects), "named": names_of(left, effects)}


def judge(verdict, answer, control=None):
    """The scored row of one case.

    @param verdict  of the tool; None if it wrote none
    @param answer   of the generator, with its truth
    @param control  the tool's verdict of the same case without the effect, if there is one
    """
    verdict = verdict or NO_VERDICT
    rules = [cause["name"] for cause in verdict["causes"] if cause.get("is_rule")]
    if has_wrong_rule(answer):
        verdict = without_rules(verdict)
    effects, cause = answer["effects"], first_cause(verdict)
    row = {
        "case": answer["case"], "family": answer.get("family"), "tier": answer.get("tier"), "kind": answer["kind"], "truth": [e["name"] for e in effects],
        "outcome": verdict["verdict"], "names": [c["name"] for c in verdict["causes"]],
        "alternatives": [a["name"] for a in cause["alternatives"]] if cause else [],
        "remainder": has_remainder(verdict),
        "has_wrong_rule": has_wrong_rule(answer), "rules": rules,
        "part": verdict["where"].get("part"), "channel": verdict["where"].get("channel"),
        "forms": [d["form"] for d in verdict.get("descriptions", [])],
        "spurious": spurious_names(verdict, effects), "named": names_of(verdict, effects), "confidence": verdict.get("confidence"),
        "tool_s": verdict.get("seconds"),
    }
    if effects:
        truths, named = [effect["truth"] for effect in effects], naming(verdict, answer)
        row.update({
            "information": min(t["information_nat"] for t in truths),
            "detectable": all(t["detectable"] for t in truths),
            "distinguishable": all(t["distinguishable"] for t in truths),
            "tie_truth": sorted({name for t in truths for name in t["tie"]}),
            "right_first": is_right_first(named, effects),
            "right_in_tie": is_right_in_tie(named, effects),
            "all_named": are_all_named(named, effects),
        })
        row.update(_record_rows(verdict, answer))
    if control is not None:
        row.update(_beside_rows(verdict, answer, control))
    if len(effects) == 1:
        row.update(_effect_row(verdict, answer, effects[0]))
    if answer["kind"] == "outside":
        row["abstained"] = is_abstention(verdict, effects)
        row["form_right"] = has_right_form(verdict, effects[0])
    return row
