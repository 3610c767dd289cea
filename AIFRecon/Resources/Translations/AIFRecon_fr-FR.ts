<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="fr_FR" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>A network that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>Un réseau qui dit où est l'os dans une image, dans un fichier ONNX. Il tourne sur le processeur de cet ordinateur, et seuls ce fichier et le JSON de son nom sont ouverts.</translation>
    </message>
    <message>
        <source>And also:</source>
        <translation>Et aussi :</translation>
    </message>
    <message>
        <source>Bone from:</source>
        <translation>Os d'après :</translation>
    </message>
    <message>
        <source>Bone:</source>
        <translation>Os :</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>TDM :</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Connexion</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>En direct</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Plus</translation>
    </message>
    <message>
        <source>Name under which the server sends what a network says (device), with the time stamps of its images</source>
        <translation>Nom sous lequel le serveur envoie ce que dit un réseau (appareil), avec les horodatages de ses images</translation>
    </message>
    <message>
        <source>Network name:</source>
        <translation>Nom du réseau :</translation>
    </message>
    <message>
        <source>Network said:</source>
        <translation>Le réseau a dit :</translation>
    </message>
    <message>
        <source>Network:</source>
        <translation>Réseau :</translation>
    </message>
    <message>
        <source>Networks (*.onnx)</source>
        <translation>Réseaux (*.onnx)</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Aucun</translation>
    </message>
    <message>
        <source>None (plain average)</source>
        <translation>Aucun (simple moyenne)</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Aucun pour l'instant</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Ouvrir enregistrement, TDM, segmentation...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>Placer la TDM sur le balayage</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Reconstruire</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Enregistrer</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Enregistré</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Dire où aller ensuite</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Réglages</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Démarrer</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Recommencer...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Arrêter</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Balayage :</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>Essayer sur un patient fictif</translation>
    </message>
    <message>
        <source>Use the scanned box</source>
        <translation>Prendre la boîte balayée</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Vertèbres :</translation>
    </message>
    <message>
        <source>What a network has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>Ce qu'un réseau a dit des images (prédictions) : une séquence d'images, une par image ou avec leurs temps, de 0 à 255 ou de 0 à 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, a neural network that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>Qui dit où est l'os : le CT à sa place, un réseau de neurones qui regarde chaque image, ou les échos, clairs avec de l'obscurité derrière. Seul le CT connaît l'os qu'aucune image ne montre.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>A network in a file needs the Python package onnxruntime. Install it now?</source>
        <translation>Un réseau dans un fichier a besoin du paquet Python onnxruntime. L'installer maintenant ?</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>L'os est connu par {looked} images sur {frames}.</translation>
    </message>
    <message>
        <source>CT agrees: {found}</source>
        <translation>La TDM concorde : {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>La TDM ne concorde pas : {found}</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Déplacez la sonde plus lentement : {fast:.0f} mm/s au plus.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Placez la TDM sur le balayage avant de croire l'image.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>Balayez encore {name}, sous d'autres angles.</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>pas encore de balayage</translation>
    </message>
    <message>
        <source>onnxruntime was not installed, and a network in a file needs it: {why}</source>
        <translation>onnxruntime n'a pas été installé, et un réseau dans un fichier en a besoin : {why}</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>connu après la reconstruction</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} prédictions n'appartiennent à aucune image avec une pose.</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}, {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and a network in a file needs it.</source>
        <translation>{packages} n'est pas installé, et un réseau dans un fichier en a besoin.</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes, {median:.1f} mm</source>
        <translation>{share:.0%} des échos, {median:.1f} mm</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} images sur {frames}</translation>
    </message>
</context>
<context>
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>Les échos eux-mêmes</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>Ce que le réseau a dit appartient à un balayage ; il y en a {predictions} pour {sweeps}. Laissez les autres de côté.</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the network has said of this sweep, in its size.</source>
        <translation>{name} : des prédictions de {got} pixels ne vont pas avec des images de {frames}. Choisissez ce que le réseau a dit de ce balayage, à sa taille.</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>A network in a file</source>
        <translation>Un réseau dans un fichier</translation>
    </message>
    <message>
        <source>A network that runs elsewhere</source>
        <translation>Un réseau qui tourne ailleurs</translation>
    </message>
    <message>
        <source>A network, as it was recorded</source>
        <translation>Un réseau, tel qu'enregistré</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>L'os est cherché dans le balayage même : ce qui est clair avec de l'obscurité derrière. La documentation dit ce que cela vaut.</translation>
    </message>
    <message>
        <source>Choose the file of the network, or let something else tell where bone is.</source>
        <translation>Choisissez le fichier du réseau, ou laissez autre chose dire où est l'os.</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the network says, or let something else tell where bone is.</source>
        <translation>Entrez le nom sous lequel le serveur envoie ce que dit le réseau, ou laissez autre chose dire où est l'os.</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>Toute étiquette supérieure à 0 est de l'os.</translation>
    </message>
    <message>
        <source>Images and what the network says of them must have two names; both are {name}.</source>
        <translation>Les images et ce que le réseau en dit doivent avoir deux noms ; les deux s'appellent {name}.</translation>
    </message>
    <message>
        <source>Select what the network has said of the sweep, or let something else tell where bone is.</source>
        <translation>Choisissez ce que le réseau a dit du balayage, ou laissez autre chose dire où est l'os.</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>Pris pour la probabilité d'os, de 0 à 1.</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>Le CT</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>Les échos eux-mêmes</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>Il n'y a pas de fichier {path}.</translation>
    </message>
    <message>
        <source>What a network says comes from a server: take the images from there too, or let something else tell where bone is.</source>
        <translation>Ce que dit un réseau vient d'un serveur : prenez-y aussi les images, ou laissez autre chose dire où est l'os.</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep: leave the others out, or let something else tell where bone is.</source>
        <translation>Ce que le réseau a dit appartient à un seul balayage : laissez les autres de côté, ou laissez autre chose dire où est l'os.</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>Sans os, le balayage est moyenné : rien ne dit sous quel angle un faisceau le rencontre.</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>Choisissez un balayage ou chargez un enregistrement.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Couverture</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Recalage</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Suivi</translation>
    </message>
    <message>
        <source>being looked at ...</source>
        <translation>examen en cours...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Bring the probe into the tracker's view</source>
        <translation>Mettez la sonde dans le champ du traqueur</translation>
    </message>
    <message>
        <source>Press Start</source>
        <translation>Appuyez sur Démarrer</translation>
    </message>
    <message>
        <source>Scan on</source>
        <translation>Continuez à balayer</translation>
    </message>
    <message>
        <source>What the network said is in {path}.</source>
        <translation>Ce que le réseau a dit est dans {path}.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>pas démarré</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>arrêté</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Terminé.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Balayage et TDM</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Balayage et TDM : {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>good</source>
        <translation>bon</translation>
    </message>
    <message>
        <source>look</source>
        <translation>à voir</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>pas encore</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>mauvais</translation>
    </message>
</context>
</TS>
