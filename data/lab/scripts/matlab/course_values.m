function v = course_values()
% Values of motor and disk in SI, each with its source, from values.json.
v = jsondecode(fileread(data_file('values.json')));
end
