function run = read_moiregauge(folder)
% READ_MOIREGAUGE  What `moiregauge measure` wrote to a folder. For MATLAB and Octave 7.
%
%   run = read_moiregauge('bridge-moiregauge');
%   mid = run.targets(1);
%   plot(mid.time_s(mid.ok), mid.dy_mm(mid.ok))
%
% run.info      run.json: version, input, camera, markers, warnings
% run.targets   one per target: name; frame, time_s, dx_mm, dy_mm, u_dx_mm, u_dy_mm (columns, NaN where nothing was
%               measured; u is a standard uncertainty, k = 1); status (words); ok (true where a number is stood by)
% x is to the right, y is up; displacements are counted from the reference frame.
  run.info = jsondecode(fileread(fullfile(folder, 'run.json')));
  file = fopen(fullfile(folder, 'displacement.csv'), 'r');
  if file < 0
    error('read_moiregauge: no displacement.csv in %s: the run was refused', folder);
  end
  header = fgetl(file);
  more = repmat(' %*s', 1, sum(header == ',') - 7);  % columns that later versions may have added
  columns = textscan(file, ['%f %f %s %f %f %f %f %s' more], 'Delimiter', ',');
  fclose(file);
  names = columns{3}(columns{1} == columns{1}(1));  % every frame has a row for every target
  run.targets = struct([]);
  for k = 1:numel(names)
    rows = strcmp(columns{3}, names{k});
    target.name = names{k};
    target.frame = columns{1}(rows);
    target.time_s = columns{2}(rows);
    target.dx_mm = columns{4}(rows);
    target.dy_mm = columns{5}(rows);
    target.u_dx_mm = columns{6}(rows);
    target.u_dy_mm = columns{7}(rows);
    target.status = strtrim(columns{8}(rows));
    target.ok = strcmp(target.status, 'ok');
    if k == 1
      run.targets = target;
    else
      run.targets(k) = target;
    end
  end
end
