#include "app/analyze_command.h"
#include "app/calibrate_camera_command.h"
#include "app/command.h"
#include "app/compare_command.h"
#include "app/critical_command.h"
#include "app/export_command.h"
#include "app/info_command.h"
#include "app/link_command.h"
#include "app/render_command.h"
#include "app/run_command.h"
#include "app/simulate_field_command.h"
#include "app/simulate_md_command.h"
#include "app/track_command.h"
#include "app/tune_command.h"
#include "app/validate_command.h"

namespace grainfield::app {

std::vector<std::unique_ptr<Command>> make_commands() {
    std::vector<std::unique_ptr<Command>> commands;
    commands.push_back(std::make_unique<RunCommand>());
    commands.push_back(std::make_unique<TrackCommand>());
    commands.push_back(std::make_unique<LinkCommand>());
    commands.push_back(std::make_unique<TuneCommand>());
    commands.push_back(std::make_unique<CalibrateCameraCommand>());
    commands.push_back(std::make_unique<SimulateMdCommand>());
    commands.push_back(std::make_unique<SimulateFieldCommand>());
    commands.push_back(std::make_unique<RenderCommand>());
    commands.push_back(std::make_unique<AnalyzeCommand>());
    commands.push_back(std::make_unique<CriticalCommand>());
    commands.push_back(std::make_unique<CompareCommand>());
    commands.push_back(std::make_unique<ValidateCommand>());
    commands.push_back(std::make_unique<ExportCommand>());
    commands.push_back(std::make_unique<InfoCommand>());
    return commands;
}

}  // namespace grainfield::app
