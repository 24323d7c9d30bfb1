#pragma once

namespace conav::study {

/// `conav study --supervision ...`: parses, runs all trials, prints the tables, writes trials.csv,
/// results.json, supervision.svg and report.html into --out. Exit code: 0 done; 1 a trial failed,
/// interrupted, or a file could not be written; 2 wrong usage.
int SupervisionMain(int argc, char** argv);

}  // namespace conav::study
