#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""./run bench regression: the engine beside scikit-learn and STK (Octave), in one run.

First the inner parts (bench/regression.cpp): Cholesky against matrix product, 100 pairs online, one
query. Then whole fits: the same table, kernel (squared exponential, one length scale per feature,
Gaussian noise, mean zero) and task (hyper-parameters by maximum likelihood, then the mean of the
test rows) for all three, one after the other, so that a busy machine is busy for each of them. Each
starts its search where it does by default or is best served; log marginal likelihood and RMSE stand
beside the time. Read the ratios, not the seconds.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

import numpy as np

STK = r"""
pkg load stk
train = csvread(argv(){1}, 1, 0); test = csvread(argv(){2}, 1, 0); d = columns(train) - 1;
x = train(:, 1:d); y = train(:, end);
model = stk_model(@stk_gausscov_aniso, d);
model.lm = stk_lm_null();
tic;
start = [log(var(y)); -log(sqrt(2 * d)) * ones(d, 1)];
[model.param, model.lognoisevariance] = stk_param_estim(model, x, y, start, log(0.01 * var(y)));
answer = stk_predict(model, x, y, test(:, 1:d));
seconds = toc;
printf('{"seconds": %.6f, "lml": %.6f, "rmse": %.8f}\n', seconds, ...
       -stk_param_relik(model, x, y), sqrt(mean((answer.mean - test(:, end)) .^ 2)));
"""


def output_of(command):
    """Standard output of a program; what it complained of is shown if it fails."""
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"bench: {' '.join(command)} failed ({run.returncode}):\n{run.stderr}")
    return run.stdout


def blas_core():
    """What OpenBLAS must be told on processors that are newer than it."""
    with open("/proc/cpuinfo", encoding="ascii") as cpuinfo:
        flags = cpuinfo.read()
    if "avx512f" in flags and "avx512vl" in flags:
        return "SkylakeX"
    return "Haswell" if "avx2" in flags else None


def make_table(rows, features, seed):
    """Smooth in some features, nearly blind to others, noise 0.1; features of unit spread."""
    random = np.random.default_rng(seed)
    x = random.standard_normal((rows, features))
    y = (np.sin(1.5 * x[:, 0]) + 0.5 * x[:, 1] * x[:, 2] + np.cos(x[:, 3])
         + 0.3 * np.tanh(x[:, 4:8].sum(axis=1)) + 0.1 * random.standard_normal(rows))
    return np.column_stack([x, y])


def write_table(file, table):
    names = [f"x{k + 1}" for k in range(table.shape[1] - 1)] + ["y"]
    np.savetxt(file, table, delimiter=",", header=",".join(names), comments="", fmt="%.12g")


def fit_ours(train, test, folder, rows):
    out = os.path.join(folder, "ours.json")
    output_of([os.path.join(os.environ["RAVEN_BUILD"], "devel/lib/raven_correction/offline"),
               "regress", "--train", train, "--test", test, "--targets", "1",
               "--kernel", "squared_exponential", "--backend", "exact",
               "--hyper-points", str(rows), "--exact-points", str(rows), "--json", out])
    with open(out, encoding="utf-8") as file:
        result = json.load(file)
    seconds = result["seconds"]
    return {"seconds": seconds["hyperparameters"] + seconds["posterior"] + seconds["predict"],
            "lml": result["log_marginal_likelihood"], "rmse": result["outputs"][0]["rmse"]}


def fit_sklearn(train, test):
    """In a process of its own, so that the choice of OPENBLAS_CORETYPE counts."""
    return json.loads(output_of(
        [sys.executable, os.path.abspath(__file__), "--sklearn-fit", train, test]))


def sklearn_fit(train, test):
    import time
    import warnings
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
    warnings.simplefilter("ignore")
    train, test = (np.loadtxt(file, delimiter=",", skiprows=1) for file in (train, test))
    d = train.shape[1] - 1
    kernel = (ConstantKernel(train[:, d].var(), (1e-5, 1e8))
              * RBF(np.full(d, np.sqrt(d)), (1e-2, 1e4))
              + WhiteKernel(0.01 * train[:, d].var(), (1e-8, 1e5)))
    start = time.perf_counter()
    process = GaussianProcessRegressor(kernel, alpha=0.0).fit(train[:, :d], train[:, d])
    mean = process.predict(test[:, :d])
    return {"seconds": time.perf_counter() - start, "lml": process.log_marginal_likelihood_value_,
            "rmse": float(np.sqrt(np.mean((mean - test[:, d]) ** 2)))}


def fit_stk(train, test, folder):
    script = os.path.join(folder, "stk.m")
    with open(script, "w", encoding="ascii") as file:
        file.write(STK)
    output = output_of(["octave-cli", "--quiet", "--no-init-file", script, train, test])
    return json.loads(output.strip().splitlines()[-1])


def compare(rows, features, repetitions, others):
    """Fits of `repetitions` tables, and for each other the medians of the ratios to ours."""
    fits = []
    with tempfile.TemporaryDirectory() as folder:
        train, test = os.path.join(folder, "train.csv"), os.path.join(folder, "test.csv")
        for seed in range(1, repetitions + 1):
            table = make_table(rows + 2000, features, seed)
            table[:, -1] -= table[:rows, -1].mean()  # none of the three has a mean to learn
            write_table(train, table[:rows])
            write_table(test, table[rows:])
            fit = {"seed": seed, "ours": fit_ours(train, test, folder, rows)}
            if "sklearn" in others:
                fit["sklearn"] = fit_sklearn(train, test)
            if "stk" in others:
                fit["stk"] = fit_stk(train, test, folder)
            fits.append(fit)
            for name in ["ours", *others]:
                one = fit[name]
                print(f"{rows:6d} {seed:5d}  {name:<8s} {one['seconds']:10.3f} s"
                      f" {one['lml']:14.3f} {one['rmse']:10.6f}", flush=True)
    result = {"n": rows, "d": features, "fits": fits}
    for name in others:
        result[name] = {
            "times_faster": statistics.median(
                fit[name]["seconds"] / fit["ours"]["seconds"] for fit in fits),
            "lml_below": max(fit[name]["lml"] - fit["ours"]["lml"] for fit in fits),
            "rmse_ratio": statistics.median(
                fit["ours"]["rmse"] / fit[name]["rmse"] for fit in fits)}
        print(f"{rows:6d}   all  {name:<8s} {result[name]['times_faster']:.1f} times slower than "
              f"ours (median); ours in LML at most {result[name]['lml_below']:.3f} below, "
              f"RMSE {result[name]['rmse_ratio']:.4f} of theirs (median)", flush=True)
    return result


def inner_parts():
    parts = {}
    output = output_of([os.path.join(os.environ["RAVEN_BUILD"], "bench/regression"),
                        "--benchmark_format=json"])
    for entry in json.loads(output)["benchmarks"]:
        known = {"name", "family_index", "per_family_instance_index", "run_name", "run_type",
                 "repetitions", "repetition_index", "threads", "iterations", "real_time",
                 "cpu_time", "time_unit"}
        parts[entry["name"].replace("/iterations:", " x")] = {
            key: value for key, value in entry.items() if key not in known}
    for name, values in parts.items():
        print(f"{name:<34s} " + ", ".join(f"{k} {v:.4g}" for k, v in values.items()
                                          if not isinstance(v, str)), flush=True)
    return parts


def main():
    parser = argparse.ArgumentParser(prog="./run bench regression", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, nargs="+", default=[460, 2000], help="training rows")
    parser.add_argument("--d", type=int, default=12, help="features")
    parser.add_argument("--repetitions", type=int, default=3, help="tables per size")
    parser.add_argument("--others", nargs="*", choices=["sklearn", "stk"],
                        default=["sklearn", "stk"], help="whom to run beside ours")
    parser.add_argument("--openblas-coretype", help="for the others (default: what fits here)")
    parser.add_argument("--skip-parts", action="store_true", help="whole fits only")
    parser.add_argument("--json", help="write the numbers as JSON")
    parser.add_argument("--sklearn-fit", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.sklearn_fit:
        print(json.dumps(sklearn_fit(*arguments.sklearn_fit)))
        return
    core = arguments.openblas_coretype or blas_core()
    if core:
        os.environ["OPENBLAS_CORETYPE"] = core
    result = {"processors": os.cpu_count(), "openblas_coretype": core,
              "load": os.getloadavg()[0]}
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, "
          f"OPENBLAS_CORETYPE={core} for the others", flush=True)
    if not arguments.skip_parts:
        result["parts"] = inner_parts()
    print(f"{'n':>6s} {'table':>5s}  {'program':<8s} {'time':>12s} {'LML':>14s} {'RMSE':>10s}")
    result["fits"] = [compare(rows, arguments.d, arguments.repetitions, arguments.others)
                      for rows in arguments.n]
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    main()
