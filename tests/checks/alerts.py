"""Alerts for Prometheus against what crspf view prints.

usage: alerts.py names RULES METRICS     each metric and each value of a label that a rule names is in /metrics, and each
                                         alert has its remedy, in a section that there is
       alerts.py firing RULES            prints a test for promtool: each alert fires where it should
"""
import re
import sys
from pathlib import Path

# What makes each alert fire within ten minutes, a value each ten seconds.
FIRES = {
    "CrspfViewAway": {'up{job="crspf"}': "0x60"},
    "CrspfServiceAway": {"crspf_up": "0x60"},
    "CrspfServiceRestarts": {"crspf_uptime_seconds": "0+10x9 0+10x9 0+10x9 0+10x30"},
    "CrspfLost": {"crspf_pose_lost": "1x60"},
    "CrspfNoScans": {"crspf_pose_age_seconds": "3+10x60"},
    "CrspfOdometryOnly": {"crspf_scans_total": "0+100x60", "crspf_scans_matched_total": "7x60"},
    "CrspfPoorMatch": {"crspf_match_result": "0x60", "crspf_pose_lost": "0x60"},
    "CrspfSourceFailed": {'crspf_source_state{source="lidar", state="failed"}': "1x60"},
    "CrspfSourceUnwell": {'crspf_source_state{source="lidar", state="stale"}': "1x60"},
    "CrspfOdometryLost": {"crspf_odometry_implausible_total": "0+1x60"},
    "CrspfThreadStuck": {'crspf_thread_alive{thread="map"}': "0x60"},
    "CrspfThreadMisses": {'crspf_thread_misses_total{thread="map"}': "0+1x60"},
    "CrspfNotRealtime": {"crspf_realtime": "0x60"},
    "CrspfPageFaults": {"crspf_process_major_faults_total": "0+1x60"},
    "CrspfScansDropped": {"crspf_scans_total": "0+100x60", "crspf_scans_skipped_total": "0+20x60"},
    "CrspfMapFull": {"crspf_map_refused_total": "0+1x60"},
    "CrspfMapUnsaved": {"crspf_map_problem": "1x60"},
    "CrspfRecordingLost": {"crspf_recording_lost_total": "0+1x60"},
    "CrspfBusDown": {"crspf_output_bus_open": "0x60"},
    "CrspfPosesUnsent": {"crspf_poses_unsent_total": "0+5x60"},
    "CrspfViewRefused": {"crspf_view_refused_total": "0+1x60"},
    "CrspfViewMistakes": {"crspf_view_mistakes_total": "0+1x60"},
}


def rules_of(file):
    """Each alert's text, by its name."""
    parts = re.split(r"^      - alert: (\w+)$", open(file).read(), flags=re.M)[1:]
    return dict(zip(parts[::2], parts[1::2]))


def has_section(document, section):
    path = Path(__file__).resolve().parents[2] / document
    headings = re.findall(r"^#+ (?:\d+\. )?(.+)$", path.read_text(), re.M) if path.exists() else []
    return section in headings if section else path.exists()


def names(rules, metrics):
    told = open(metrics).read()
    wrong = []
    for alert, text in rules.items():
        expression = re.search(r"expr: (.*?)\n        for: \d+[sm]\n", text, re.S)
        if not expression or not re.search(r"severity: (critical|warning)\n", text) or "summary: " not in text:
            wrong.append(f"{alert}: without expr, for, severity or summary")
            continue
        document = re.search(r"description: .*\b(docs/\w+\.md)(?:, ([^.]+))?\.\"", text)
        if not document:
            wrong.append(f"{alert}: the description does not end with a document")
        elif not has_section(document[1], document[2]):
            wrong.append(f"{alert}: {document[1]}, {document[2]}: no such document or section")
        used = set(re.findall(r"\bcrspf_\w+", expression[1]))
        wrong += [f"{alert}: {name} is not in /metrics" for name in used if f"# TYPE {name} " not in told]
        wrong += [f"{alert}: the state {state} is not in /metrics" for states in re.findall(r'state=~?"([^"]*)"', expression[1])
                  for state in states.split("|") if f'state="{state}"' not in told]
        if not used and "up{" not in expression[1]:
            wrong.append(f"{alert}: of no metric")
    print("\n".join(wrong + [f"alerts: {len(rules)}, {len(wrong)} wrong"]))
    return bool(wrong) or not rules


def firing(rules):
    missing = rules.keys() ^ FIRES.keys()
    if missing:
        print(f"alerts.py does not know what makes these fire: {missing}", file=sys.stderr)
        return True
    print("rule_files: [crspf-alerts.yml]\nevaluation_interval: 10s\ntests:")
    for alert, series in FIRES.items():
        print(f"  - interval: 10s\n    name: {alert}\n    input_series:")
        for name, values in series.items():
            print(f"      - {{series: '{name}', values: '{values}'}}")
        # Which alerts there are, whatever their labels and words.
        print("    promql_expr_test:\n"
              f"      - expr: count(ALERTS{{alertname=\"{alert}\", alertstate=\"firing\"}}) > bool 0\n"
              "        eval_time: 9m\n        exp_samples: [{value: 1}]")
    return False


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "names":
        sys.exit(names(rules_of(sys.argv[2]), sys.argv[3]))
    if len(sys.argv) == 3 and sys.argv[1] == "firing":
        sys.exit(firing(rules_of(sys.argv[2])))
    sys.exit(__doc__)
