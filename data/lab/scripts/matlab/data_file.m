function path = data_file(name)
% A file of the course: next to these sources, as in the zip, or in the folder above.
here = fileparts(mfilename('fullpath'));
path = fullfile(here, name);
if ~exist(path, 'file')
    path = fullfile(here, '..', name);
end
end
