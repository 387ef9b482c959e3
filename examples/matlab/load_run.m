function run = load_run(file)
%LOAD_RUN  Recording of a run (run.h5): run.time [s], run.values with one row per time and one
%   column per signal [SI], run.names, run.units. Missing values are NaN.
%
%   run = load_run('out/srmd_lprb_2d/latest/run.h5');
%   plot(run.time, run.values(:, strcmp(run.names, 'srmd.long.displ.fbk')))
run = struct('time', double(h5read(file, '/time')) * 1e-9, 'values', [], 'names', {{}}, 'units', {{}});
rows = numel(run.time);
signals = h5info(file, '/signals');
for partition = {signals.Datasets.Name}
    path = ['/signals/' partition{1}];
    values = h5read(file, path)';  % MATLAB reads the dimensions of HDF5 in reverse order
    run.values = [run.values, values(1:rows, :)];
    run.names = [run.names; h5readatt(file, path, 'names')];
    run.units = [run.units; h5readatt(file, path, 'units')];
end
end
