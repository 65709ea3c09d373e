#pragma once
// The subcommands of the program: what the command line says, and the functions that do it. Each returns an exit code
// or throws (base/error.h); main() in frana.cpp is the only one that catches.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace frana {

class Interrupt;

/// `frana run CASE [--out DIR] [--set key=value]... [--threads N] [--until T] [--resume] [--overwrite] [--quiet]
/// [--progress json]`
struct RunOptions {
    std::filesystem::path case_file;
    std::filesystem::path out;      ///< empty: out/<case name>
    std::vector<std::string> sets;  ///< "key=value" overrides, in order
    int threads = 0;                ///< 0: as OMP_NUM_THREADS or the machine says
    std::optional<double> until;    ///< stop at this simulated time instead of time.end [s]
    bool resume = false;            ///< go on from the folder's checkpoint.h5
    bool overwrite = false;         ///< replace the files of an earlier run in the folder
    bool quiet = false;
    std::string progress;                  ///< "json": lines for other programs; empty: for people
    const Interrupt* interrupt = nullptr;  ///< listens for Ctrl-C; nullptr: the run itself does
};

/// `frana converge CASE --cells N,N,... [--out DIR] [--set key=value]... [--threads N] [--resume] [--overwrite] [--quiet]`
struct ConvergeOptions {
    std::filesystem::path case_file;
    std::string cells;              ///< as given: "10,5,2.5"
    std::string per_cell, cfl;      ///< as given, of more runs on the finest cell; empty: none
    std::filesystem::path out;      ///< empty: out/<case name>_converge
    std::vector<std::string> sets;  ///< "key=value" overrides of all runs
    int threads = 0;
    bool resume = false;     ///< take finished runs as they are, and go on with the others
    bool overwrite = false;  ///< replace the files of an earlier study
    bool quiet = false;
};

/// `frana ensemble FILE --out DIR [--threads N] [--shard I/N] [--resume] [--check] [--exceed FIELD=VALUE]... [--quiet]
/// [--progress json]`, or with `--join DIR`, `--again SAMPLE`, `--slurm N`
struct EnsembleOptions {
    std::filesystem::path file;       ///< empty with `join`: the one that the runs were made with
    std::filesystem::path out;        ///< folder of the runs and the maps
    std::filesystem::path join;       ///< a folder whose runs are made into maps, or empty
    std::string shard;                ///< as given: "3/40"; empty: all samples, then the maps
    std::vector<std::string> exceed;  ///< "FIELD=VALUE", besides those of the file
    std::optional<long long> again;   ///< a sample to write as a case of its own
    long long slurm = 0;              ///< shards of a job script to print; 0: none
    int threads = 0;
    bool resume = false, check = false, quiet = false;
    std::string progress;  ///< as of a run
};

/// `frana calibrate FILE --out DIR [--threads N] [--resume] [--overwrite] [--quiet] [--progress json]`
struct CalibrateOptions {
    std::filesystem::path file, out;
    int threads = 0;
    bool resume = false, overwrite = false, quiet = false;
    std::string progress;  ///< as of a run
};

/// `frana figures RUN_DIR [--time T] [--size WxH] [--film mp4|gif] [--web]`
struct FiguresOptions {
    std::filesystem::path run_dir;
    std::string film;            ///< "mp4", "gif"; empty: none
    bool web = false;            ///< figures/view.html alone
    std::optional<double> time;  ///< simulated time [s]; nothing: the last frame
    int width = 1600;            ///< [pixels]
    int height = 1200;           ///< [pixels]
};

/// `frana compare RUN_DIR [--survey FOOTPRINT] [--deposit RASTER] [--bed-change RASTER] [--bed-change-noise M]
/// [--path LINE] [--json FILE]`
struct CompareOptions {
    std::filesystem::path run_dir;
    std::filesystem::path survey, deposit, path, bed_change;  ///< or empty; one of `survey` and `bed_change` is given
    double bed_change_noise = 0.1;                            ///< [m]
    std::filesystem::path json;  ///< empty: RUN_DIR/compare.json, or named after the survey
};

/// `frana states RUN_DIR [NAME...]`
struct StatesOptions {
    std::filesystem::path run_dir;
    std::vector<std::string> names;  ///< those that must be there; empty: whatever the run has
};

/// `frana check CASE [--set key=value]...`
struct CheckOptions {
    std::filesystem::path case_file;
    std::vector<std::string> sets;
};

/// `frana describe [KEY] [--json]`, or with `--markdown`, `--combinations`, `--parameters`
struct DescribeOptions {
    std::string key;  ///< a key, a table or the beginning of either; empty: all
    bool json = false, markdown = false, combinations = false, parameters = false;
};

/// `frana particles CASE --out FILE [--count N] [--set key=value]...`
struct ParticlesOptions {
    std::filesystem::path case_file;
    std::filesystem::path out;
    std::vector<std::string> sets;
    std::optional<long long> count;  ///< as particles.count
};

/// `frana convert RUN_DIR --time T --spacing R --out FILE [--layers centres|end-points] [--vertical along-bed|zero]
/// [--profile plug|linear|parabolic|bagnold] [--window xmin,ymin,xmax,ymax]`, or
/// `frana convert RUN_DIR --points FILE.h5 --back DIR`
struct ConvertOptions {
    std::filesystem::path run_dir, out;
    std::optional<double> time;          ///< [s]
    std::optional<double> spacing;       ///< vertical, between points [m]
    std::filesystem::path points, back;  ///< the other way: 3D points to read, folder of the rasters
    std::string layers = "centres", vertical = "along-bed", profile = "plug";
    std::vector<double> window;  ///< map coordinates; empty: everything
};

/// `frana verify [NAME...] [--list] [--cells N,N,...] [--preset P] [--points N] [--json FILE] [--table FILE]
/// [--against FILE]
/// [--figure FILE.png] [--study]`
struct VerifyOptions {
    std::vector<std::string> names;  ///< empty: all
    bool list = false;
    bool coarse = false;           ///< finest grids that take long are left out
    std::vector<long long> cells;  ///< empty: each problem's own grids
    std::string preset = "default";
    int per_cell = 0;  ///< points a cell: a square, of 3D problems a cube; 0: 2 a direction
    int threads = 0;
    std::filesystem::path json, table;  ///< files to write, or empty
    std::filesystem::path against;      ///< table to compare with, or empty
    std::filesystem::path figure;       ///< PNG of error over run time, with other codes, or empty
    bool study = false;                 ///< what each component of the scheme is worth
};

/// `frana bench [--json FILE] [--particles N,N,...] [--threads N,N,...] [--quick]`
struct BenchOptions {
    std::filesystem::path json;        ///< file to write, or empty
    std::vector<long long> particles;  ///< of the full step; empty: 70 000, 500 000 and 4 000 000
    std::vector<int> threads;          ///< empty: 1 and 2
    bool quick = false;
};

/// `frana stress [--seconds S] [--seed N] [--scenes N] [--first N] [--shrunk N] [--json FILE] [--out DIR]
/// [--model WORDS] [--cfl-map [--figure FILE.png]]
/// [--case CASE --steps N [--rests] [--mirror x|y|diagonal] [--same-threads] [--same-resumed]]`
struct FuzzOptions {
    double seconds = 60.0;       ///< of running scenes; shrinking comes on top
    std::string models = "all";  ///< to draw of: all, or words with commas
    long long seed = 1;
    long long scenes = 0;                      ///< at most so many; 0: as many as the time allows
    long long first = 0;                       ///< number of the first
    long long shrunk = 20;                     ///< failures that are shrunk and saved; the others are counted
    std::filesystem::path json;                ///< file to write, or empty
    std::filesystem::path out = "out/stress";  ///< where cases of failing scenes go
    std::filesystem::path known;      ///< list of failures that are known (lines: seed model scene invariant), or empty
    bool cfl_map = false;             ///< instead: the largest stable scheme.cfl of each scheme
    std::filesystem::path figure;     ///< PNG of it, or empty
    std::filesystem::path case_file;  ///< instead: this case under watch, or empty
    long long steps = 100;            ///< of it
    bool rests = false, same_threads = false, same_resumed = false;
    std::string mirror = "none";
};

int fuzz_command(const FuzzOptions& options);            // frana_fuzz.cpp
int bench_command(const BenchOptions& options);          // frana_bench.cpp
int verify_command(const VerifyOptions& options);        // frana_verify.cpp
int run_command(const RunOptions& options);              // frana_run.cpp
int converge_command(const ConvergeOptions& options);    // frana_converge.cpp
int ensemble_command(const EnsembleOptions& options);    // frana_ensemble.cpp
int calibrate_command(const CalibrateOptions& options);  // frana_calibrate.cpp
int figures_command(const FiguresOptions& options);      // frana_figures.cpp
int compare_command(const CompareOptions& options);      // frana_compare.cpp
int states_command(const StatesOptions& options);        // frana_states_command.cpp
int check_command(const CheckOptions& options);          // frana_check.cpp
int describe_command(const DescribeOptions& options);    // frana_describe.cpp
int particles_command(const ParticlesOptions& options);  // frana_particles.cpp
int convert_command(const ConvertOptions& options);      // frana_convert.cpp
int convert_back(const ConvertOptions& options);         // frana_convert_back.cpp

}  // namespace frana
